"""Cycles in closed form: named ones, thresholds, polygons, and the slap maps."""
