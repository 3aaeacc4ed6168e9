"""Cycles followed in a letter: branches, the events on them, and the curves that the events draw."""
