"""Point cloud maps: streets driven with a lidar, scans merged and thinned out, PCD files."""
