"""Claims about camera models: a direction, projected by the model's own formula, comes back to its pixel."""

import math

import numpy as np
import pytest
from carla_driver_interface._proto import sensorsim_pb2 as messages
from carla_driver_interface.geometry import Pose
from hypothesis import given
from hypothesis import strategies as st

from basu_alpasim.faces import TURNS, faces_of, turn_of
from basu_alpasim.lens import LensError, directions, ideal_fov_deg

WIDTH, HEIGHT = 64, 48
MIDDLE = {"principal_point_x": 30.5, "principal_point_y": 25.0}


def spec(**lens: object) -> messages.CameraSpec:
    """Return a camera of 64 x 48 pixels."""
    return messages.CameraSpec(logical_id="front", resolution_w=WIDTH, resolution_h=HEIGHT, **lens)


def middles() -> tuple[np.ndarray, np.ndarray]:
    """Return x and y of the middles of the pixels."""
    return np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)


def test_a_distorted_pinhole_is_projected_back_to_its_pixels() -> None:
    """By OpenCV's formula with all twelve coefficients."""
    k = [-0.2, 0.05, 0.01, 0.1, 0.02, 0.003]
    p, s = [0.001, -0.002], [0.0005, 0.0001, -0.0004, 0.0002]
    lens = {"focal_length_x": 40.0, "focal_length_y": 42.0, "radial_coeffs": k, "tangential_coeffs": p}
    x, y, z = np.moveaxis(
        directions(spec(opencv_pinhole_param={**MIDDLE, **lens, "thin_prism_coeffs": s}), 64, 48), -1, 0
    )
    x, y = x / z, y / z
    r2 = x**2 + y**2
    radial = (1 + k[0] * r2 + k[1] * r2**2 + k[2] * r2**3) / (1 + k[3] * r2 + k[4] * r2**2 + k[5] * r2**3)
    there_x = x * radial + 2 * p[0] * x * y + p[1] * (r2 + 2 * x**2) + s[0] * r2 + s[1] * r2**2
    there_y = y * radial + p[0] * (r2 + 2 * y**2) + 2 * p[1] * x * y + s[2] * r2 + s[3] * r2**2
    u_px, v_px = middles()
    assert there_x * 40.0 + 30.5 == pytest.approx(u_px, abs=1e-3)
    assert there_y * 42.0 + 25.0 == pytest.approx(v_px, abs=1e-3)


def test_a_fisheye_is_projected_back_to_its_pixels_and_shows_nothing_beyond_its_widest_angle() -> None:
    k = [0.05, -0.01, 0.002, -0.0003]
    lens = {"focal_length_x": 30.0, "focal_length_y": 30.0, "radial_coeffs": k, "max_angle": 1.0}
    x, y, z = np.moveaxis(directions(spec(opencv_fisheye_param={**MIDDLE, **lens}), 64, 48), -1, 0)
    angle = np.arccos(z)
    away_px = 30.0 * angle * (1 + k[0] * angle**2 + k[1] * angle**4 + k[2] * angle**6 + k[3] * angle**8)
    u_px, v_px = middles()
    seen = np.isfinite(z)
    assert 0.5 < seen.mean() < 1.0
    assert away_px[seen] == pytest.approx(np.hypot(u_px - 30.5, v_px - 25.0)[seen], abs=1e-3)
    assert np.arctan2(y, x)[seen] == pytest.approx(np.arctan2(v_px - 25.0, u_px - 30.5)[seen], abs=1e-9)
    assert np.nanmax(angle) <= 1.0


@pytest.mark.parametrize("kind", ["forward", "backward"])
def test_an_f_theta_lens_has_the_angles_of_its_polynomial(kind: str) -> None:
    """Both polynomials describe the same lens: 30 pixels for one radian."""
    of_kind = {
        "forward": {"reference_poly": "ANGLE_TO_PIXELDIST", "angle_to_pixeldist_poly": [0.0, 30.0]},
        "backward": {"reference_poly": "PIXELDIST_TO_ANGLE", "pixeldist_to_angle_poly": [0.0, 1.0 / 30.0]},
    }
    cde = {"linear_c": 1.1, "linear_d": 0.02, "linear_e": -0.03}
    lens = {**MIDDLE, **of_kind[kind], "max_angle": 3.0, "linear_cde": cde}
    x, y, z = np.moveaxis(directions(spec(ftheta_param=lens), 64, 48), -1, 0)
    angle, turn = np.arccos(z), np.arctan2(y, x)
    ideal_x, ideal_y = 30.0 * angle * np.cos(turn), 30.0 * angle * np.sin(turn)
    u_px, v_px = middles()
    assert 1.1 * ideal_x + 0.02 * ideal_y + 30.5 == pytest.approx(u_px, abs=1e-3)
    assert -0.03 * ideal_x + ideal_y + 25.0 == pytest.approx(v_px, abs=1e-3)


def test_a_picture_of_another_size_has_the_same_field_of_view() -> None:
    middle = {"principal_point_x": 32.0, "principal_point_y": 24.0}
    camera = spec(opencv_pinhole_param={**middle, "focal_length_x": 32.0, "focal_length_y": 32.0})
    assert ideal_fov_deg(camera, 64, 48) == pytest.approx(90.0)
    assert ideal_fov_deg(camera, 128, 96) == pytest.approx(90.0)
    assert ideal_fov_deg(camera, 128, 48) is None
    assert (
        ideal_fov_deg(spec(opencv_pinhole_param={**MIDDLE, "focal_length_x": 32.0, "focal_length_y": 32.0}), 64, 48)
        is None
    )


@pytest.mark.parametrize(
    ("lens", "sentence"),
    [
        ({}, "has no parameters"),
        ({"ftheta_param": {}}, "no reference_poly"),
        ({"ftheta_param": {"reference_poly": "PIXELDIST_TO_ANGLE"}}, "no pixeldist_to_angle_poly"),
        (
            {"ftheta_param": {"reference_poly": 2, "angle_to_pixeldist_poly": [0.0, -5.0]}},
            "does not rise with the angle",
        ),
        ({"ftheta_param": {"reference_poly": 2, "angle_to_pixeldist_poly": [0.0, 5.0], "linear_cde": {}}}, "inverted"),
        ({"opencv_pinhole_param": {}}, "must be above 0"),
        ({"opencv_fisheye_param": {"focal_length_x": float("nan")}}, "must be above 0"),
        ({"opencv_pinhole_param": {}, "bivariate_windshield_model_param": {}}, "windshield"),
    ],
)
def test_a_camera_that_is_none_is_refused_by_a_sentence(lens: dict[str, object], sentence: str) -> None:
    with pytest.raises(LensError, match=sentence):
        directions(spec(**lens), WIDTH, HEIGHT)


def test_a_camera_without_a_resolution_is_refused() -> None:
    with pytest.raises(LensError, match="no resolution"):
        directions(messages.CameraSpec(opencv_pinhole_param={}), WIDTH, HEIGHT)


@given(st.floats(-math.pi, math.pi), st.floats(-1.4, 1.4))
def test_each_face_looks_where_its_name_says(yaw: float, pitch: float) -> None:
    """The colour that is sampled for a direction is that of the direction."""
    looks = np.array([math.cos(pitch) * math.sin(yaw), -math.sin(pitch), math.cos(pitch) * math.cos(yaw)])
    near = looks + 0.01 * np.cross(looks, [0.3, 0.5, -0.8])
    faces = faces_of(np.stack([looks, near / np.linalg.norm(near)])[None])
    seen = {name: painted(faces.size_px, faces.fov_deg, name) for name in faces.pixels}
    assert faces.picture(seen)[0, 0] == pytest.approx(np.rint(100.0 + 100.0 * looks), abs=2)


def painted(size_px: int, fov_deg: float, face: str) -> np.ndarray:
    """Return a face's picture of a sphere whose colour is 100 plus 100 times the direction."""
    places = (np.arange(size_px) + 0.5 - size_px / 2.0) * math.tan(math.radians(fov_deg / 2.0)) / (size_px / 2.0)
    x, y = np.meshgrid(places, places)
    rays = np.stack([x, y, np.ones_like(x)], axis=-1)
    rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    turned = turn_of(face).apply(rays.reshape(-1, 3)).reshape(rays.shape)
    return np.rint(100.0 + 100.0 * turned).clip(0, 255).astype(np.uint8)


def test_the_names_of_the_faces_are_those_of_the_camera_s_axes() -> None:
    axes = {
        "front": [0, 0, 1],
        "right": [1, 0, 0],
        "left": [-1, 0, 0],
        "back": [0, 0, -1],
        "up": [0, -1, 0],
        "down": [0, 1, 0],
    }
    assert {name: np.rint(turn_of(name).apply([0.0, 0.0, 1.0])).tolist() for name in TURNS} == axes
    camera = Pose.from_xyz_yaw(1.0, 2.0, 3.0, 0.4)
    assert faces_of(np.full((1, 2, 3), [0.0, 0.0, 1.0])).pose(camera, "front").position.tolist() == [1.0, 2.0, 3.0]


def test_a_lens_that_shows_nothing_makes_a_black_picture() -> None:
    assert dict(faces_of(np.full((2, 2, 3), np.nan)).pixels) == {}
