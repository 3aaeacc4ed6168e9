"""What is a periodic orbit? Three neighbours and one rule, how the ring closes, its multipliers, how it bifurcates."""
