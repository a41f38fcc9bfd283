"""Street facts in GeoJSON to OpenDRIVE."""
