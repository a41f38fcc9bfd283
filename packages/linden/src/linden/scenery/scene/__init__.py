"""The scene of a map: things beside the streets as boxes, street lamps, debug shapes."""
