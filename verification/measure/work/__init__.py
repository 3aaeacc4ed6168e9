"""Work-precision: error against run time for whole questions."""
