"""Invariant manifolds of saddles, and where two of them touch."""
