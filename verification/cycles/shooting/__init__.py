"""One cycle at a time, to any precision: its equations, Newton iteration, condition and normal form."""
