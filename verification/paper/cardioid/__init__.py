"""Judges of the cardioid and the cuspless table. Paper: sections 4 and 5."""
