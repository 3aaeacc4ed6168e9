"""Stiff and extreme cases under names, with what every kernel makes of them: `docs/extremes.md`."""
