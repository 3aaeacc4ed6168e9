"""The flights of each family of tables, each a plain function over an abstract arithmetic."""
