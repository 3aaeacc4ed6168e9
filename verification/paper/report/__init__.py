"""What `make verify` leaves behind: a page, Markdown, JSON and LaTeX."""
