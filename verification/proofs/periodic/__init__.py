"""Proofs on periodic orbits: interval Newton, checklists of bifurcations, statements over a parameter interval."""
