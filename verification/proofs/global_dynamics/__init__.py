"""Global dynamics: attractor blocks, Morse graphs, horseshoes, proved by covering phase space with boxes."""
