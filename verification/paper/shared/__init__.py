"""Judges that more than one table needs."""
