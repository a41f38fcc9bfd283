"""A map as an SVG picture, north up, one unit a metre: surfaces, marks, furniture, words."""
