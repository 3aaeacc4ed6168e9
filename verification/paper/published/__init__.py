"""Judges of claims of other papers: on polygons, on elastic tables, and on reflection laws."""
