"""How much weaker a message is where it arrives: path loss, vehicles in the way, and fading.

Source of meaning: CARLA 0.9.16, PathLossModel.cpp. Its ``winner`` follows ETSI TR 103 257-1 V1.1.1 (from WINNER+ D5.3).
Its ``geometric`` has the two-ray model of Sommer, Joerer and Dressler 2012, "On the Applicability of Two-Ray Path Loss
Models for Vehicular Network Simulation". One fault is left out. A
vehicle in the way bends the wave by the height of its roof above the straight line between the antennas (Recommendation
ITU-R P.526, 4.1); CARLA takes the height above the ground.
"""

import math
from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

from linden.sensors.devices.radio.spec import ChannelSpec, PathLossModel, Scenario

LIGHT_MPS = 299_792_458.0
NEAREST_M = 0.1
"""Distances below count as this one: the formulas grow without limit at 0."""
_GROUND_PERMITTIVITY = 1.02
"""Relative, of the road, in the two-ray model: CARLA's figure, fitted by Sommer et al."""

_DARKEST = 1e-6
"""Of the interference: antennas on the road itself would hear nothing at all."""


class PathState(Enum):
    """What is between two antennas, by ETSI's names."""

    FREE = "LOS"
    VEHICLES = "NLOSv"
    BUILDINGS = "NLOSb"


class Edge(NamedTuple):
    """The roof of a vehicle in the way: how far it is from either antenna in the plane, and above the line, m."""

    first_m: float
    second_m: float
    height_m: float


class Path(NamedTuple):
    """The way between two antennas; heights are those above the ground under the lower of the two carriers, m."""

    distance_m: float
    transmitter_m: float
    receiver_m: float
    state: PathState = PathState.FREE
    edges: Sequence[Edge] = ()


_FADING_DB = {
    PathState.FREE: {Scenario.HIGHWAY: 3.3, Scenario.RURAL: 4.25, Scenario.URBAN: 5.2},
    PathState.VEHICLES: {Scenario.HIGHWAY: 3.8, Scenario.RURAL: 4.55, Scenario.URBAN: 5.3},
    PathState.BUILDINGS: {Scenario.HIGHWAY: 6.8, Scenario.RURAL: 6.8, Scenario.URBAN: 6.8},
}
"""Standard deviations of ETSI TR 103 257-1, table 6; for the country, where it has none, CARLA takes the means."""


def fading_db(spec: ChannelSpec, state: PathState) -> float:
    """Return the standard deviation of shadow fading."""
    return _FADING_DB[state][spec.scenario] if spec.etsi_fading else spec.custom_fading_db


def path_loss_db(spec: ChannelSpec, path: Path) -> float:
    """Return the loss along a path, without fading."""
    wavelength_m = LIGHT_MPS / (spec.frequency_ghz * 1e9)
    distance_m = max(path.distance_m, NEAREST_M)
    bent_db = max((edge_loss_db(edge, wavelength_m) for edge in path.edges), default=0.0)
    if spec.model is PathLossModel.WINNER:
        return _winner_db(spec, path.state, distance_m) + bent_db
    if path.state is PathState.FREE:
        return two_ray_db(distance_m, path.transmitter_m, path.receiver_m, wavelength_m)
    if path.state is PathState.VEHICLES:
        return free_space_db(distance_m, wavelength_m) + bent_db
    reference_db = free_space_db(spec.reference_distance_m, wavelength_m)
    return reference_db + 10.0 * spec.path_loss_exponent * math.log10(distance_m / spec.reference_distance_m)


def _winner_db(spec: ChannelSpec, state: PathState, distance_m: float) -> float:
    """Return the loss by ETSI TR 103 257-1, from WINNER+ D5.3."""
    far, high = math.log10(distance_m), math.log10(spec.frequency_ghz)
    if state is PathState.BUILDINGS:
        return 36.85 + 30.0 * far + 18.9 * high
    if spec.scenario is Scenario.HIGHWAY:
        return 32.4 + 20.0 * far + 20.0 * high
    return 38.77 + 16.7 * far + 18.2 * high


def free_space_db(distance_m: float, wavelength_m: float) -> float:
    """Return the loss in free space (Friis)."""
    return 20.0 * math.log10(4.0 * math.pi * distance_m / wavelength_m)


def two_ray_db(distance_m: float, transmitter_m: float, receiver_m: float, wavelength_m: float) -> float:
    """Return the loss of the wave and its reflection from the road together (Sommer et al., equations 6 to 9).

    Args:
        distance_m: between the antennas.
        transmitter_m: height of one antenna above the road.
        receiver_m: height of the other.
        wavelength_m: of the carrier.
    """
    across_m = math.sqrt(max(NEAREST_M**2, distance_m**2 - (transmitter_m - receiver_m) ** 2))
    reflected_m = math.hypot(across_m, transmitter_m + receiver_m)
    sine, cosine = (transmitter_m + receiver_m) / reflected_m, across_m / reflected_m
    root = math.sqrt(_GROUND_PERMITTIVITY - cosine**2)
    reflection = (sine - root) / (sine + root)
    phase = math.tau * (distance_m - reflected_m) / wavelength_m
    interference = math.hypot(1.0 + reflection * math.cos(phase), reflection * math.sin(phase))
    return free_space_db(across_m, wavelength_m) - 20.0 * math.log10(max(interference, _DARKEST))


def edge_loss_db(edge: Edge, wavelength_m: float) -> float:
    """Return the loss at a knife edge (Recommendation ITU-R P.526, equations 26 and 31)."""
    first_m, second_m = max(edge.first_m, NEAREST_M), max(edge.second_m, NEAREST_M)
    v = edge.height_m * math.sqrt(2.0 * (first_m + second_m) / (wavelength_m * first_m * second_m))
    return 6.9 + 20.0 * math.log10(math.hypot(v - 0.1, 1.0) + v - 0.1) if v > -0.78 else 0.0
