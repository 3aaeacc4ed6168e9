"""Motion on a table: flight, reflection, derivative, chord rule, and what a bounce contracts."""
