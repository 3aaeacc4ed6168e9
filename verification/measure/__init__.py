"""Error and run time: benchmark problems, extreme cases, speed."""
