"""What scenarios do: one idea a file."""

from basu.scenarios.actions.action import Action
from basu.scenarios.actions.arrival import ReachAtEgosArrival
from basu.scenarios.actions.composition import Either, InTurn, Meanwhile, Together, Wait
from basu.scenarios.actions.driving import DriveAlong
from basu.scenarios.actions.ego_controls import Bump, JitterControls, PullSteering
from basu.scenarios.actions.following import FollowEgo
from basu.scenarios.actions.lateral import ChangeLane, Drift
from basu.scenarios.actions.moments import (
    CloseDoor,
    LetGo,
    OpenDoor,
    PutAt,
    Remove,
    SetFriction,
    SetLight,
    SetWeather,
)
from basu.scenarios.actions.pedals import Accelerate, Brake, Hold
from basu.scenarios.actions.puppet import Limits, Puppet
from basu.scenarios.actions.walking import WalkAlong

__all__ = [
    "Accelerate",
    "Action",
    "Brake",
    "Bump",
    "ChangeLane",
    "CloseDoor",
    "Drift",
    "DriveAlong",
    "Either",
    "FollowEgo",
    "Hold",
    "InTurn",
    "JitterControls",
    "LetGo",
    "Limits",
    "Meanwhile",
    "OpenDoor",
    "PullSteering",
    "Puppet",
    "PutAt",
    "ReachAtEgosArrival",
    "Remove",
    "SetFriction",
    "SetLight",
    "SetWeather",
    "Together",
    "Wait",
    "WalkAlong",
]
