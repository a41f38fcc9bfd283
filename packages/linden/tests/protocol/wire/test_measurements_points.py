"""Lidar and radar messages, byte by byte as CARLA lays them out."""

import struct

import numpy as np

from linden.protocol.wire.measurements import RADAR_DETECTION, lidar_payload, radar_payload


def test_a_sweep_is_its_angle_its_channels_how_many_points_each_has_and_the_points() -> None:
    points = np.arange(12, dtype=np.float32).reshape(3, 4)
    packed = b"".join(lidar_payload(1.5, np.array([1, 2], np.uint32), points))
    assert packed == struct.pack("<fIII", 1.5, 2, 1, 2) + struct.pack("<12f", *range(12))


def test_a_sweep_without_points_still_has_its_channels() -> None:
    packed = b"".join(lidar_payload(0.0, np.zeros(2, np.uint32), np.empty((0, 4), np.float32)))
    assert packed == struct.pack("<fIII", 0.0, 2, 0, 0)


def test_a_detection_is_velocity_azimuth_altitude_and_depth() -> None:
    detections = np.array([(-3.0, 0.1, -0.2, 40.0)], RADAR_DETECTION)
    assert b"".join(radar_payload(detections)) == struct.pack("<4f", -3.0, 0.1, -0.2, 40.0)
