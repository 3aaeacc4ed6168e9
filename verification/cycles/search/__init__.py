"""All cycles up to a period: seeds, correction in float64, catalogue and counts."""
