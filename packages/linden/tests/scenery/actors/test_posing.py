"""Where parts are: many at once as one by one."""

import numpy as np
import pytest

from linden.blueprints.skeleton import in_component, walking_pose
from linden.geometry import rotation_matrix
from linden.protocol.values.space import Rotation
from linden.scenery.actors.posing import FORK, WALKER_BONES, posed_frames, vehicle_frames, walker_frames


def test_walkers_together_are_posed_as_the_skeleton_poses_each():
    random = np.random.default_rng(4)
    stature, walked, speed = random.uniform(1.0, 2.0, 30), random.uniform(0.0, 9.0, 30), random.uniform(0.0, 2.0, 30)
    frames = walker_frames(stature, walked, speed)
    for who in range(30):
        bones = in_component(walking_pose(stature[who], walked[who], speed[who]))
        bones[:, 2, 3] -= 0.5 * stature[who]  # the actor's origin is half way up
        np.testing.assert_allclose(frames[who], posed_frames(bones), atol=1e-12)


def test_a_walker_that_stands_has_feet_half_a_stature_below():
    frames = walker_frames(np.array([1.8]), np.array([3.3]), np.array([0.0]))[0]
    ankle = frames[1 + WALKER_BONES.index("crl_foot__L"), :, 3]
    assert ankle[2] == pytest.approx(-0.9 + 0.039 * 1.8)


def test_a_wheel_steers_about_the_upright_and_rolls_about_its_axle():
    hubs = np.array([[[1.4, -0.8, 0.3], [1.4, 0.8, 0.3], [-1.4, -0.8, 0.3], [-1.4, 0.8, 0.3]]])
    steer, rolled = np.array([[0.3, 0.25, 0.0, 0.0]]), np.array([[0.7, 0.8, 0.9, 1.0]])
    frames = vehicle_frames(hubs, steer, rolled)[0]
    np.testing.assert_allclose(frames[0], np.eye(4)[:3])
    for wheel in range(4):
        expected = rotation_matrix(Rotation(-np.degrees(rolled[0, wheel]), np.degrees(steer[0, wheel]), 0.0))
        np.testing.assert_allclose(frames[1 + wheel, :, :3], expected, atol=1e-12)
        np.testing.assert_allclose(frames[1 + wheel, :, 3], hubs[0, wheel])


def test_the_fork_steers_with_the_first_wheel_and_does_not_roll():
    frames = vehicle_frames(np.ones((1, 4, 3)), np.full((1, 4), 0.4), np.full((1, 4), 2.0))[0]
    np.testing.assert_allclose(frames[FORK, :, :3], rotation_matrix(Rotation(0.0, np.degrees(0.4), 0.0)), atol=1e-12)


def test_the_top_of_a_wheel_goes_forward():
    frames = vehicle_frames(np.zeros((1, 4, 3)), np.zeros((1, 4)), np.full((1, 4), 0.1))[0]
    assert (frames[1, :, :3] @ (0.0, 0.0, 1.0))[0] > 0.0
