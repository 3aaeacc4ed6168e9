"""The commands, found by name when they are called."""
