"""Is it true, how well, and at what cost: claims, certificates, reports and the command line."""
