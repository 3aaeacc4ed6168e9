"""The slap maps: periodic points, critical points, and the exponent of the natural measure."""
