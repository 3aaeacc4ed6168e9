"""Judges of claims in other papers: on polygons, on elastic tables, and on reflection laws."""
