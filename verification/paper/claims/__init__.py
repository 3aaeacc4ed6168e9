"""Claims as printed, and what a judge may say of them."""
