"""Rotations as CARLA has them, held against its official client, and the way from OpenDRIVE's frame."""

import carla
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from linden.geometry import compose, from_opendrive, rotation_matrix, rotation_of
from linden.protocol.values.space import Rotation, Transform, Vector3D

angles = st.floats(-179.0, 179.0)
pitches = st.floats(-89.0, 89.0)
metres = st.floats(-1000.0, 1000.0)
rotations = st.builds(Rotation, pitches, angles, angles)
transforms = st.builds(Transform, st.builds(Vector3D, metres, metres, metres), rotations)


def official(transform: Transform) -> carla.Transform:
    return carla.Transform(carla.Location(*transform.location), carla.Rotation(*transform.rotation))


@given(rotations)
def test_the_matrix_is_the_official_clients(rotation: Rotation) -> None:
    theirs = np.array(official(Transform(rotation=rotation)).get_matrix())[:3, :3]
    np.testing.assert_allclose(rotation_matrix(rotation), theirs, atol=1e-5)  # theirs has single precision


@given(rotations)
def test_a_rotation_comes_back_from_its_matrix(rotation: Rotation) -> None:
    matrix = rotation_matrix(rotation)
    np.testing.assert_allclose(rotation_matrix(rotation_of(matrix)), matrix, atol=1e-9)


@pytest.mark.parametrize("pitch", [90.0, -90.0])
def test_straight_up_and_down_come_back_too(pitch: float) -> None:
    matrix = rotation_matrix(Rotation(pitch, 30.0, 40.0))
    np.testing.assert_allclose(rotation_matrix(rotation_of(matrix)), matrix, atol=1e-6)


@given(transforms, transforms)
def test_composition_puts_points_where_the_official_client_does(outer: Transform, inner: Transform) -> None:
    theirs = official(outer).transform(carla.Location(*inner.location))
    ours = compose(outer, inner).location
    np.testing.assert_allclose(ours, [theirs.x, theirs.y, theirs.z], atol=2e-3)


def test_north_is_minus_y_and_a_left_turn_is_minus_yaw() -> None:
    assert from_opendrive(1.0, 2.0, 3.0, np.pi / 2) == Transform(Vector3D(1.0, -2.0, 3.0), Rotation(0.0, -90.0, 0.0))
