"""The parts of a case's picture: the encounter, the canvas, trails, boxes, labels, the legend."""
