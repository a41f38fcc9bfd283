"""The motion of rows: bodies are copied, children follow their parents, the rest stay where they were put."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fleet import column
from linden.geometry import compose, rotation_matrix
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.simulation.snapshot_rows import gather_motion

metres = st.floats(-1e4, 1e4)
poses = st.builds(
    lambda *v: Transform(Vector3D(*v[:3]), Rotation(*v[3:])),
    metres, metres, metres, st.floats(-89, 89), st.floats(-179, 179), st.floats(-179, 179),
)  # fmt: skip


def gather(pose, relative, parent_row, slot, bodies):
    motion = np.full((len(pose), 15), np.nan, np.float32)
    rows = np.array(parent_row, np.int32), np.array(slot, np.int32)
    gather_motion(len(pose), pose, relative, *rows, *map(column, bodies), motion)
    return motion


def no_bodies():
    return tuple(np.zeros((1, 3)) for _ in range(5))


@given(poses, poses)
def test_a_child_stands_where_composition_puts_it(parent: Transform, relative: Transform) -> None:
    pose = np.array([[*parent.location, *parent.rotation], [0.0] * 6])
    offsets = np.array([[0.0] * 6, [*relative.location, *relative.rotation]])
    gather(pose, offsets, [-1, 0], [-1, -1], no_bodies())
    expected = compose(parent, relative)
    np.testing.assert_allclose(pose[1, :3], expected.location, atol=1e-6)
    np.testing.assert_allclose(rotation_matrix(Rotation(*pose[1, 3:])), rotation_matrix(expected.rotation), atol=1e-6)


def test_a_child_that_looks_straight_down_keeps_its_turn() -> None:
    pose = np.array([[0.0, 0.0, 0.0, 0.0, 30.0, 0.0], [0.0] * 6])
    relative = np.array([[0.0] * 6, [0.0, 0.0, 0.0, -90.0, 0.0, 20.0]])
    gather(pose, relative, [-1, 0], [-1, -1], no_bodies())
    expected = rotation_matrix(Rotation(0.0, 30.0, 0.0)) @ rotation_matrix(Rotation(-90.0, 0.0, 20.0))
    np.testing.assert_allclose(rotation_matrix(Rotation(*pose[1, 3:])), expected, atol=1e-6)


def test_a_child_of_a_child_follows_both() -> None:
    pose = np.array([[1.0, 2.0, 3.0, 0.0, 90.0, 0.0], [0.0] * 6, [0.0] * 6])
    relative = np.array([[0.0] * 6, [1.0, 0.0, 0.0, 0.0, 90.0, 0.0], [1.0, 0.0, 0.5, 0.0, 0.0, 0.0]])
    gather(pose, relative, [-1, 0, 1], [-1, -1, -1], no_bodies())
    np.testing.assert_allclose(pose[2, :3], [0.0, 3.0, 3.5], atol=1e-12)
    assert abs(pose[2, 4]) == pytest.approx(180.0)


def test_a_body_is_copied_in_degrees_with_its_yaw_wrapped() -> None:
    bodies = (
        np.array([[1.0, 2.0, 3.0]]),
        np.radians([[0.0, 270.0, 0.0]]),
        np.array([[4.0, 5.0, 6.0]]),
        np.radians([[7.0, 8.0, 9.0]]),
        np.array([[1.5, 2.5, 3.5]]),
    )
    motion = gather(np.zeros((1, 6)), np.zeros((1, 6)), [-1], [0], bodies)
    np.testing.assert_allclose(motion[0], [1, 2, 3, 0, -90, 0, 4, 5, 6, 7, 8, 9, 1.5, 2.5, 3.5], rtol=1e-6)


def test_an_actor_without_body_and_parent_stays_and_stands_still() -> None:
    motion = gather(np.array([[9.0, 8.0, 7.0, 1.0, 2.0, 3.0]]), np.zeros((1, 6)), [-1], [-1], no_bodies())
    np.testing.assert_array_equal(motion[0], [9, 8, 7, 1, 2, 3] + [0] * 9)


@pytest.mark.parametrize("yaw_deg", [180.0, -180.0, 540.0])
def test_a_body_that_looks_west_has_a_yaw_of_plus_180_as_in_unreal(yaw_deg: float) -> None:
    bodies = tuple(np.radians([[0.0, yaw_deg, 0.0]]) if column == 1 else np.zeros((1, 3)) for column in range(5))
    motion = gather(np.zeros((1, 6)), np.zeros((1, 6)), [-1], [0], bodies)
    assert motion[0, 4] == 180.0
