"""Other drivers: the vehicles they come in, by the words that parameters use, and how they set off."""

from __future__ import annotations

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
SETS_OFF_MPS2 = 3.5  # somebody in a hurry: half of what tyres give


def run_up_m(speed_mps: float, notice_s: float) -> float:
    """How far before a place one stands who has to be there, at that speed, so long after setting off."""
    rise_s = speed_mps / SETS_OFF_MPS2
    if notice_s <= rise_s:
        return 0.5 * SETS_OFF_MPS2 * notice_s * notice_s
    return speed_mps * notice_s - 0.5 * speed_mps * rise_s
