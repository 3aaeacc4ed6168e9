"""One module for each question; each has a `command`, which `verification.cli` loads when it is asked."""
