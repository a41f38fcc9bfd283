"""What there is of a drive while it lasts: infractions and scores for those who look on, at the cost of what is new."""

from basu.metrics.so_far.drive import SoFar

__all__ = ["SoFar"]
