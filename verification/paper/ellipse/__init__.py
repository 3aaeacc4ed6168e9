"""Judges of the map, the circle, the ellipse and the appendix. Paper: sections 2, 3 and the appendix."""
