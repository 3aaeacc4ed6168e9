"""What every command needs: the group, scenes as options, output, sweeps."""
