"""Traffic lights and signs, made from the map's signals."""
