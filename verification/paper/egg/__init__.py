"""Judges of the claims on the egg with three vertices. Paper: section 6."""
