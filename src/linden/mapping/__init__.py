"""Making maps: street facts in GeoJSON to OpenDRIVE."""
