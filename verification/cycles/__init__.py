"""Periodic orbits: search, Newton iteration, continuation, normal forms, cascades."""
