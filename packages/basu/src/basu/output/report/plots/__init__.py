"""Plots of a record for reports: charts of downsampled signals, a timeline of events and a map, in HTML and SVG."""
