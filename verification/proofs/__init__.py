"""Proofs in balls, a room for each subject."""
