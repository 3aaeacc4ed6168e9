"""The figures of the paper, each a function that computes its data and one that draws them.

Data come as panels of named point sequences (`panel`); drawing turns panels into a Matplotlib figure (`sheet`), and
nothing here imports Matplotlib before something is drawn. `catalogue` knows the names, and the captions they are
looked at beside lie in `captions.toml`, as printed.
"""
