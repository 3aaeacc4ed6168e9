"""Branches of cycles: what becomes of one as a parameter changes."""
