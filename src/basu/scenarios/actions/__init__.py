"""What scenarios do: one idea a file."""

from basu.scenarios.actions.composition import Either, InTurn, Meanwhile, Together, Wait
from basu.scenarios.actions.driving import DriveAlong
from basu.scenarios.actions.pedals import Accelerate, Brake, Hold
from basu.scenarios.actions.walking import WalkAlong

__all__ = [
    "Accelerate",
    "Brake",
    "DriveAlong",
    "Either",
    "Hold",
    "InTurn",
    "Meanwhile",
    "Together",
    "Wait",
    "WalkAlong",
]
