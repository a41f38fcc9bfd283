"""Vector maps for Autoware, made from OpenDRIVE: Lanelet2 (.osm) and Aisan (.csv)."""
