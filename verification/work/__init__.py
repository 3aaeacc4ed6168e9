"""Error against run time for whole questions: work-precision diagrams, with certified balls as the truth.

A `Question` has a reference in balls and methods, each with a ladder of settings; `measure` runs them and gives rows.
`catalogue` lists the questions, `front` says which rows no other beats, `figure` and `text` show them, and
`choice` picks the cheapest arithmetic for a number of digits from a table that was measured.
"""
