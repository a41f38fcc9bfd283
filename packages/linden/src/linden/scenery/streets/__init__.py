"""Meshes of the ground: lanes, kerbs, junction floors, paint, railroad, terrain."""
