"""How what a looking sensor measured goes over the wire: its kind, and the bytes behind the header, by its type."""

from collections.abc import Callable
from typing import Any

from linden.sensors.lidar import SemanticSweep, Sweep
from linden.simulation import Simulation
from linden.simulation.measuring import Measurement
from linden.wire.headers import SensorType
from linden.wire.points import lidar_payload

Encode = Callable[[Simulation, Measurement, Any], tuple[SensorType, bytes]]


def _sweep(_simulation: Simulation, _measurement: Measurement, reading: Sweep) -> tuple[SensorType, bytes]:
    return SensorType.LIDAR, lidar_payload(*reading)


def _semantic(_simulation: Simulation, _measurement: Measurement, reading: SemanticSweep) -> tuple[SensorType, bytes]:
    return SensorType.LIDAR_SEMANTIC, lidar_payload(*reading)


ENCODERS: dict[type, Encode] = {Sweep: _sweep, SemanticSweep: _semantic}
