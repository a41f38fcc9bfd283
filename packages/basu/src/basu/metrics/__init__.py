"""Scores, infractions and metrics as functions of a recorded history; what a metric of a user's own is made of."""

from basu.metrics.infraction import Evidence, OwnKind, evidence
from basu.metrics.registry import Column, Drive, Metric

__all__ = ["Column", "Drive", "Evidence", "Metric", "OwnKind", "evidence"]
