"""Meshes of vehicles and people: solids, true to the boxes of their blueprints."""
