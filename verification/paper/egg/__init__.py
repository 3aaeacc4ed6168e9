"""Judges of the three-pointed egg. Paper: section 6."""
