"""Proofs in exact arithmetic: signs over boxes, and identities."""
