"""All cycles of a scene up to a period: found by search, counted a second way, for short periods proved complete."""
