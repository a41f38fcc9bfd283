"""One page over all results of a folder: runs, series, scenario runs, campaigns, and trends between versions."""
