"""Sheets of panels, and the drawings that more than one room uses."""
