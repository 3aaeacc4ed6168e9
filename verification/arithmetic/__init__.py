"""Numbers that know what they promise: balls, working precision, jets and Taylor models."""
