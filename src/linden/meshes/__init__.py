"""Triangles of what is seen: streets and what stands beside them once per map, and one body for each kind of actor."""
