"""The vehicles that other drivers come in, by the words that parameters use."""

from __future__ import annotations

BLUEPRINTS = {
    "car": "vehicle.lincoln.mkz_2020",
    "suv": "vehicle.nissan.patrol_2021",
    "van": "vehicle.mercedes.sprinter",
    "motorcycle": "vehicle.kawasaki.ninja",
    "bus": "vehicle.mitsubishi.fusorosa",
    "truck": "vehicle.carlamotors.carlacola",
    "bicycle": "vehicle.diamondback.century",
}
HALF_LENGTH_M = {  # of their boxes, rounded up, for places that must be known before they are in the world
    "car": 2.5,
    "suv": 2.8,
    "van": 3.0,
    "motorcycle": 1.1,
    "bus": 5.2,
    "truck": 2.7,
    "bicycle": 0.9,
}
EGO_HALF_LENGTH_M = 2.0  # of the shuttle: gaps are meant between bumpers; a longer ego has a little less
