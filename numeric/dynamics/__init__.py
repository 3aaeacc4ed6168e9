"""Attractors, exponents with error bars, basins, statistics of orbits."""
