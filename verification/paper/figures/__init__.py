"""The figures of the paper, as data and as pictures."""
