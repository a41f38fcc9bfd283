"""Claims about the packed headers: the struct that writes and the dtype that reads are the same layout."""

import numpy as np

from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.protocol.wire.measurements import (
    EPISODE_HEADER,
    SENSOR_HEADER,
    SensorType,
    SimulationState,
    episode_header,
    sensor_header,
)


def test_a_sensor_header_reads_as_it_was_written() -> None:
    pose = Transform(Vector3D(1.0, 2.0, 3.0), Rotation(4.0, 5.0, 6.0))
    (header,) = np.frombuffer(sensor_header(SensorType.IMU, 7, 0.5, pose), SENSOR_HEADER)
    assert (header["sensor_type"], header["frame"], header["timestamp"]) == (5, 7, 0.5)
    assert list(header["location"]) == [1.0, 2.0, 3.0]
    assert list(header["rotation"]) == [4.0, 5.0, 6.0]


def test_an_episode_header_reads_as_it_was_written() -> None:
    state = SimulationState.MAP_CHANGE | SimulationState.PENDING_LIGHT_UPDATE
    (header,) = np.frombuffer(episode_header(3, 12.5, 0.05, state), EPISODE_HEADER)
    assert (header["episode_id"], header["platform_timestamp"], header["simulation_state"]) == (3, 12.5, 3)
    assert header["delta_seconds"] == np.float32(0.05)
    assert not header["map_origin"].any()


def test_no_type_is_offered_that_ends_the_client() -> None:
    assert {6, 12}.isdisjoint(SensorType)
    assert max(SensorType) < 22
