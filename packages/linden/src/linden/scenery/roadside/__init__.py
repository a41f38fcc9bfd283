"""Meshes of what stands beside the streets: houses, yards, trees, posts, wires, parked cars."""
