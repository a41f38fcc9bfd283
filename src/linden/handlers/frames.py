"""What one frame looks like on the wire: the world's snapshot, and what its sensors measured."""

import msgpack

from linden.handlers.readings import ENCODERS, described, scenery
from linden.sensors.collision import SCENERY, Collision
from linden.sensors.imu import ImuMeasurement
from linden.simulation import Simulation
from linden.simulation.measuring import Measurement
from linden.values.space import Transform
from linden.wire.headers import SensorType, SimulationState, episode_header, sensor_header


def world_payload(simulation: Simulation) -> bytes:
    """Return the world snapshot: headers and one row for each actor.

    The platform's time stamp repeats the simulated time, for no clock's may be in it: two runs are equal byte by byte
    (docs/decisions/0003-determinism.md).
    """
    episode = simulation.episode
    state = SimulationState.MAP_CHANGE if simulation.map_changed else SimulationState.NONE
    if episode.surroundings.lamps.pending:
        state |= SimulationState.PENDING_LIGHT_UPDATE
    return b"".join(
        (
            sensor_header(SensorType.WORLD_OBSERVER, simulation.frame, episode.elapsed_s, Transform()),
            episode_header(simulation.episode_id, episode.elapsed_s, simulation.delta_s, state),
            episode.actors.rows[: len(episode.actors)].tobytes(),
        )
    )


def sensor_payloads(simulation: Simulation, listened: set[int]) -> list[tuple[int, bytes]]:
    """Return (stream id, message) of everything that sensors measured in this frame for somebody who listens."""
    return [(item.sensor.stream_id, _payload(simulation, item)) for item in simulation.measure(listened)]


def _payload(simulation: Simulation, measurement: Measurement) -> bytes:
    if (encode := ENCODERS.get(type(measurement.reading))) is not None:
        kind, parts = encode(simulation, measurement, measurement.reading)
    else:
        kind, body = _encoded(simulation, measurement)
        parts = (msgpack.packb(body),)
    header = sensor_header(kind, simulation.frame, simulation.elapsed_s, measurement.pose)
    return b"".join((header, *parts))  # type: ignore[arg-type] # numpy's stubs know buffers from Python 3.12 on


def _encoded(simulation: Simulation, measurement: Measurement) -> tuple[SensorType, object]:
    """Return the sensor's index and the value that msgpack carries after the header."""
    reading = measurement.reading
    if isinstance(reading, Collision):
        actors = simulation.episode.actors
        own = described(actors.of_slot(reading.slot))
        if reading.other_slot == SCENERY:
            other = scenery(reading.scenery_type)
        else:
            other = described(actors.of_slot(reading.other_slot))
        return SensorType.COLLISION, (own, other, reading.impulse_ns)
    return SensorType.IMU if isinstance(reading, ImuMeasurement) else SensorType.GNSS, reading
