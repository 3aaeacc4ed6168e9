"""On what numbers does a program run? LLVM vectors, NumPy arrays, single numbers of any precision: one protocol."""
