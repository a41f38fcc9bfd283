"""Lanelet2 maps: from OpenDRIVE, to and from ``.osm`` files."""
