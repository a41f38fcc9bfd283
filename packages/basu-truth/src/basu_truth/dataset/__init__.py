"""Data sets of recorded drives: shards of samples, which training programs stream."""
