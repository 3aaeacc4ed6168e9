"""Text and programs from expressions, in a closed vocabulary that every number system reads."""
