"""The paper: its claims and their judges, its figures, the report."""
