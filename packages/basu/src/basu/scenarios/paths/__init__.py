"""Paths to be followed: from points, along lanes, beside and across the ego's route."""

from basu.scenarios.paths.crossings import Crossing, JunctionAhead, crossing, crossings, junctions, next_junction
from basu.scenarios.paths.lanes import along_lane, lanes_apart_m, oncoming, parked_m, pavement_m
from basu.scenarios.paths.path import OnPath, Path

__all__ = [
    "Crossing",
    "JunctionAhead",
    "OnPath",
    "Path",
    "along_lane",
    "crossing",
    "crossings",
    "junctions",
    "lanes_apart_m",
    "next_junction",
    "oncoming",
    "parked_m",
    "pavement_m",
]
