"""Theorems on the paper's billiards, proved in ball arithmetic: one package for each subject."""
