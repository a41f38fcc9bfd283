"""Drawing a map as SVG: north up, one unit a metre."""
