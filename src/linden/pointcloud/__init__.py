"""Point cloud maps: streets driven with a lidar, scans brought together and thinned out, PCD files."""
