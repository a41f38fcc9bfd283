"""A run in Rerun's viewer: streamed while it lasts, kept as ``run.rrd``, and shown again from its record alone."""
