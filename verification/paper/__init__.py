"""Verification of the paper: its claims with their judges, its figures, and the report."""
