"""The judges of the sentences that are not on the egg: the map, circle and ellipse, the cardioids, what is sampled."""
