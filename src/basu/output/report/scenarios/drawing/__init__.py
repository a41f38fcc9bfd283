"""The parts of a case's picture: who met whom where, what is shown of it, trails, boxes, labels, the legend."""
