"""Other road users: the vehicles they drive, how they set off, and their ways across a street on foot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from basu.records.partners import ANIMALS
from basu.scenarios.paths import Path
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import TimeToArrival

if TYPE_CHECKING:
    from basu.scenarios.place import Place
    from basu.scenarios.stage import Pose


BLUEPRINTS = {
    "car": "vehicle.lincoln.mkz_2020",
    "suv": "vehicle.nissan.patrol_2021",
    "van": "vehicle.mercedes.sprinter",
    "motorcycle": "vehicle.kawasaki.ninja",
    "truck": "vehicle.carlamotors.carlacola",
    "bicycle": "vehicle.diamondback.century",
}
HALF_LENGTH_M = {  # of their boxes, rounded up, for places that must be known before they are in the world
    "car": 2.5,
    "suv": 2.8,
    "van": 3.0,
    "motorcycle": 1.1,
    "truck": 2.7,
    "bicycle": 0.9,
}
EGO_HALF_LENGTH_M = 2.0  # of the shuttle: gaps are meant between bumpers; a longer ego has a little less
SETS_OFF_MPS2 = 3.5  # a hurried driver: half of what tyres give


STAND_INS = {"deer": "walker.pedestrian.0048", "dog": "walker.pedestrian.0009"}
"""Walkers of a child's size, 0.5 m across and 1.1 m high, for a simulator without animals: the original CARLA."""


def animal(name: str, kind: str, pose: Pose) -> ActorSpec:
    """A deer or a dog by its role; Linden's `data/blueprints.json` has their sizes and masses, with sources."""
    return ActorSpec(name, f"{ANIMALS}{kind}", pose, stand_in=STAND_INS[kind])


def run_up_m(speed_mps: float, notice_s: float) -> float:
    """The run-up, in m, of a vehicle that reaches a place at that speed so long after setting off."""
    rise_s = speed_mps / SETS_OFF_MPS2
    if notice_s <= rise_s:
        return 0.5 * SETS_OFF_MPS2 * notice_s * notice_s
    return speed_mps * notice_s - 0.5 * speed_mps * rise_s


Side = Literal["right", "left"]
FRONT_M = 2.2  # from a vehicle's middle to its bumper: the shuttle's is 2.0 m, a car's about 2.4 m
STARTS_MPS2 = 8.0  # how walkers get going, as linden.physics.walker has it


def other_side(side: str) -> Side:
    """The side across the street."""
    return "left" if side == "right" else "right"


def across(place: Place, ahead_m: float, from_right_m: float, to_right_m: float) -> Path:
    """Straight across the route."""
    return Path.through([place.at(ahead_m, from_right_m)[:3], place.at(ahead_m, to_right_m)[:3]])


def facing_deg(from_right_m: float) -> float:
    """The heading of a person beside the route that looks across it."""
    return -90.0 if from_right_m > 0.0 else 90.0


def walking_s(distance_m: float, speed_mps: float) -> float:
    """The time that a standing walker needs for a distance."""
    return distance_m / speed_mps + speed_mps / (2.0 * STARTS_MPS2)


def ego_is_due(place: Place, ahead_m: float, seconds: float, what: str) -> TimeToArrival:
    """The ego's bumper is so many seconds from a place ahead of the trigger point."""
    return TimeToArrival(place.trigger_s_m + ahead_m - FRONT_M, seconds, what)
