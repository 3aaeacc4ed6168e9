"""What expressions are: signs proved, and text generated that every number system reads."""
