"""The arithmetics that can run a step: LLVM lanes, NumPy arrays, and scalars of any precision."""
