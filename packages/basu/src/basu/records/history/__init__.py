"""The record of a run, the input of metrics: `History` with frames and events, `Recorder`, files, tables, SUMO data."""

from basu.records.history.model import FRAME, OTHER, Collision, Facts, History, LaneInvasion, Vehicle
from basu.records.history.recorder import Recorder

__all__ = ["FRAME", "OTHER", "Collision", "Facts", "History", "LaneInvasion", "Recorder", "Vehicle"]
