"""The corner orbit of the cuspless table, and the chaotic attractor that is born there."""
