"""What happened in a run, frame by frame: all that metrics may see."""

from basu.records.history.model import FRAME, OTHER, Collision, Facts, History, LaneInvasion, Vehicle
from basu.records.history.recorder import Recorder

__all__ = ["FRAME", "OTHER", "Collision", "Facts", "History", "LaneInvasion", "Recorder", "Vehicle"]
