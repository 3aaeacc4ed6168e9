"""What has a name: bifurcations, crises, attractors that are proved, and certificate files."""
