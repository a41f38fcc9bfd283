"""Meshes of props: solids, stretched to the boxes of their blueprints."""
