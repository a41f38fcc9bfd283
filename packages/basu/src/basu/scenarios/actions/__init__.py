"""Actions of scenarios: motion of vehicles and walkers, disturbed ego controls, weather, friction, lights, doors."""

from basu.scenarios.actions.cut_in import SlowerUntilTtc
from basu.scenarios.actions.driving import DriveAlong, FollowEgo, ReachAtEgosArrival
from basu.scenarios.actions.ego_controls import JitterControls, PullSteering
from basu.scenarios.actions.maneuvers import Accelerate, BackUp, Brake, ChangeLane, Drift, Hold
from basu.scenarios.actions.one_frame import (
    Action,
    CloseDoor,
    Either,
    InTurn,
    LetGo,
    Meanwhile,
    OpenDoor,
    PutAt,
    Remove,
    SetFriction,
    SetLight,
    SetWeather,
    Together,
    Wait,
)
from basu.scenarios.actions.path_follower import FollowerLimits, PathFollower
from basu.scenarios.actions.walking import WalkAlong

__all__ = [
    "Accelerate",
    "Action",
    "BackUp",
    "Brake",
    "ChangeLane",
    "CloseDoor",
    "Drift",
    "DriveAlong",
    "Either",
    "FollowEgo",
    "FollowerLimits",
    "Hold",
    "InTurn",
    "JitterControls",
    "LetGo",
    "Meanwhile",
    "OpenDoor",
    "PathFollower",
    "PullSteering",
    "PutAt",
    "ReachAtEgosArrival",
    "Remove",
    "SetFriction",
    "SetLight",
    "SetWeather",
    "SlowerUntilTtc",
    "Together",
    "Wait",
    "WalkAlong",
]
