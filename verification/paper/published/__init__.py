"""What other papers say of polygons, of elastic tables and of reflection laws: who judges each of their sentences."""
