"""Grids of tasks: chunks, seeds, stores, threads and clusters."""
