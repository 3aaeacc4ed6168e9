"""The map to any precision, in mpmath and in balls, with the first hit proved."""
