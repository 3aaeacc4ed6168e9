"""The live table: a page of this machine."""
