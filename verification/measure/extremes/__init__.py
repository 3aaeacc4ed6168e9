"""Extreme and stiff cases, measured against 50 digits and recorded."""
