"""Runs: preparation, the drive, series, scenario cases, and the folder of each run."""
