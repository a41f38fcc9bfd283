"""Others whose way crosses the ego's at a junction, or joins it there."""
