"""The skeleton: human proportions, a gait that repeats with every stride, poses between poses."""

import math

import numpy as np
import pytest

from linden.blueprints.skeleton import blended, frame_of, in_component, skeleton, transform_of, walking_pose
from linden.protocol.values.space import Rotation, Transform, Vector3D

STATURE_M = 1.8
STRIDE_M = 0.83 * STATURE_M


def heights(walked_m: float, speed_mps: float = 1.4) -> dict[str, float]:
    frames = in_component(walking_pose(STATURE_M, walked_m, speed_mps))
    return dict(zip(skeleton().names, frames[:, 2, 3].tolist(), strict=True))


def test_parents_come_before_their_children_and_bones_are_named_as_carla_does() -> None:
    bones = skeleton()
    assert len(bones.names) == len(set(bones.names)) == 66
    assert all(parent < row for row, parent in enumerate(bones.parents))
    assert {"crl_root", "crl_hips__C", "crl_Head__C", "crl_hand__L", "crl_toeEnd__R"} <= set(bones.names)


def test_standing_is_upright_and_symmetric() -> None:
    frames = in_component(walking_pose(STATURE_M, 12.3, 0.0))
    place = dict(zip(skeleton().names, frames[:, :3, 3], strict=True))
    for name in skeleton().names:
        if name.endswith("__L"):
            mirrored = place[name[:-1] + "R"] * np.array([1.0, -1.0, 1.0])
            np.testing.assert_allclose(place[name], mirrored, atol=1e-12)
    assert place["crl_arm__R"][2] / STATURE_M == pytest.approx(0.818)  # Winter, fig. 4.1: acromion
    assert place["crl_leg__R"][2] / STATURE_M == pytest.approx(0.285)  # knee
    assert 0.90 < place["crl_eye__L"][2] / STATURE_M < 0.95


def test_the_pose_repeats_with_every_stride_and_half_a_stride_swaps_the_sides() -> None:
    first = walking_pose(STATURE_M, 0.4, 1.4)
    np.testing.assert_allclose(walking_pose(STATURE_M, 0.4 + STRIDE_M, 1.4), first, atol=1e-9)
    swapped = walking_pose(STATURE_M, 0.4 + STRIDE_M / 2.0, 1.4)
    right, left = skeleton().row("crl_leg__R"), skeleton().row("crl_leg__L")
    np.testing.assert_allclose(swapped[left, :3, :3], first[right, :3, :3], atol=1e-9)


def test_the_lower_foot_stands_on_the_ground_all_along() -> None:
    for share in np.linspace(0.0, 1.0, 41):
        height = heights(share * STRIDE_M)
        ankle, toe = 0.039 * STATURE_M, 0.010 * STATURE_M
        lowest = min(
            height[f"crl_{part}__{side}"] - up for part, up in (("foot", ankle), ("toe", toe)) for side in "LR"
        )
        assert lowest == pytest.approx(0.0, abs=1e-3)
        assert 0.47 < height["crl_hips__C"] / STATURE_M < 0.54


def test_between_two_poses_turns_are_shared_out() -> None:
    first = frame_of(Transform(Vector3D(), Rotation()))[None]
    second = frame_of(Transform(Vector3D(1.0, 2.0, 3.0), Rotation(0.0, 80.0, 0.0)))[None]
    middle = transform_of(blended(first, second, 0.25)[0])
    assert middle.location == pytest.approx((0.25, 0.5, 0.75))
    assert middle.rotation.yaw == pytest.approx(20.0)
    np.testing.assert_allclose(blended(first, second, 1.0), second, atol=1e-12)


def test_half_a_turn_has_no_way_round_and_jumps_in_the_middle() -> None:
    first, second = np.eye(4)[None], np.diag([-1.0, -1.0, 1.0, 1.0])[None]
    assert blended(first, second, 0.4)[0, 0, 0] == 1.0
    assert blended(first, second, 0.6)[0, 0, 0] == -1.0
    assert math.isfinite(float(blended(first, first, 0.5).sum()))
