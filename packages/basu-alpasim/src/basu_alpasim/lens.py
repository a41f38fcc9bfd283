"""Camera models of AlpaSim: which way each pixel of a picture looks.

Formulas: OpenCV's pinhole with rational, tangential and thin-prism distortion and its fisheye model (OpenCV's manual,
modules calib3d and fisheye); f-theta as NVIDIA's ``FthetaCameraParam`` describes it. Directions have the axes of the
optical frame: x right, y down, z along the axis. The middle of the first pixel is at (0.5, 0.5).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from carla_driver_interface._proto.sensorsim_pb2 import FthetaCameraParam

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from carla_driver_interface.protocol import CameraSpec
    from numpy.typing import NDArray

MIDDLE_PX, SQUARE = 0.01, 1e-4
"""How far an ideal camera's principal point may lie off the middle, and its focal lengths apart, relative to one."""
ITERATIONS = 30  # of the undistortion; OpenCV's undistortPoints has 5 by default
ANGLES = 4096  # of the table that inverts a polynomial of angles
STRAIGHT = 1e-9  # of an angle in rad or a distance: below it a ray is the axis


class LensError(Exception):
    """A camera cannot be served; a sentence that says why."""


def ideal_fov_deg(spec: CameraSpec, width: int, height: int) -> float | None:
    """Return the horizontal field of view of an ideal pinhole camera, and None for every other camera."""
    if spec.WhichOneof("camera_param") != "opencv_pinhole_param":
        return None
    lens = spec.opencv_pinhole_param
    scale_x, scale_y = _scales(spec, width, height)
    focal_x, focal_y = lens.focal_length_x * scale_x, lens.focal_length_y * scale_y
    if any((*lens.radial_coeffs, *lens.tangential_coeffs, *lens.thin_prism_coeffs)):
        return None
    off_px = max(abs(lens.principal_point_x * scale_x - width / 2), abs(lens.principal_point_y * scale_y - height / 2))
    if focal_x <= 0.0 or abs(focal_x - focal_y) > SQUARE * focal_x or off_px > MIDDLE_PX:
        return None
    return math.degrees(2.0 * math.atan(width / (2.0 * focal_x)))


def directions(spec: CameraSpec, width: int, height: int) -> NDArray[np.float64]:
    """Return the (height, width, 3) unit vectors along which the pixels look; NaN where the lens shows nothing.

    Raises:
        LensError: the model is unknown, or its parameters are no camera.
    """
    if spec.WhichOneof("external_distortion") is not None:
        raise LensError("a windshield's distortion (bivariate_windshield_model_param) is not supported")
    scale_x, scale_y = _scales(spec, width, height)
    u_px, v_px = np.meshgrid((np.arange(width) + 0.5) / scale_x, (np.arange(height) + 0.5) / scale_y)
    kind = spec.WhichOneof("camera_param")
    if kind == "opencv_pinhole_param":
        return _pinhole(spec, u_px, v_px)
    if kind == "opencv_fisheye_param":
        return _fisheye(spec, u_px, v_px)
    if kind == "ftheta_param":
        return _ftheta(spec, u_px, v_px)
    raise LensError("the camera has no parameters: set ftheta_param, opencv_pinhole_param or opencv_fisheye_param")


def _scales(spec: CameraSpec, width: int, height: int) -> tuple[float, float]:
    """Return the picture's pixels for one pixel of the calibration, in x and y."""
    if not (spec.resolution_w and spec.resolution_h):
        raise LensError("camera_intrinsics has no resolution; set resolution_w and resolution_h")
    return width / spec.resolution_w, height / spec.resolution_h


def _pinhole(spec: CameraSpec, u_px: NDArray[np.float64], v_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the directions of OpenCV's pinhole, by fixed-point iteration over its distortion."""
    lens = spec.opencv_pinhole_param
    x_0, y_0 = _normalised(lens, u_px, v_px)
    k = _padded(lens.radial_coeffs, 6)
    p, s = _padded(lens.tangential_coeffs, 2), _padded(lens.thin_prism_coeffs, 4)
    x, y = x_0.copy(), y_0.copy()
    for _ in range(ITERATIONS):
        r2 = x * x + y * y
        radial = (1 + ((k[2] * r2 + k[1]) * r2 + k[0]) * r2) / (1 + ((k[5] * r2 + k[4]) * r2 + k[3]) * r2)
        away_x = 2 * p[0] * x * y + p[1] * (r2 + 2 * x * x) + s[0] * r2 + s[1] * r2 * r2
        away_y = p[0] * (r2 + 2 * y * y) + 2 * p[1] * x * y + s[2] * r2 + s[3] * r2 * r2
        with np.errstate(all="ignore"):
            x, y = (x_0 - away_x) / radial, (y_0 - away_y) / radial
    return _unit(x, y, np.ones_like(x))


def _fisheye(spec: CameraSpec, u_px: NDArray[np.float64], v_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the directions of OpenCV's fisheye: the distance is an odd polynomial of the angle."""
    lens = spec.opencv_fisheye_param
    x, y = _normalised(lens, u_px, v_px)
    k = _padded(lens.radial_coeffs, 4)

    def distance(angle: NDArray[np.float64]) -> NDArray[np.float64]:
        a2 = angle * angle
        return angle * (1 + (((k[3] * a2 + k[2]) * a2 + k[1]) * a2 + k[0]) * a2)

    return _turned(x, y, _inverse(distance, lens.max_angle or math.pi / 2.0))


def _ftheta(spec: CameraSpec, u_px: NDArray[np.float64], v_px: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the directions of an f-theta lens; ``linear_cde`` maps ideal to real offsets as [[c, d], [e, 1]]."""
    lens = spec.ftheta_param
    x, y = u_px - lens.principal_point_x, v_px - lens.principal_point_y
    if lens.HasField("linear_cde"):
        c, d, e = lens.linear_cde.linear_c, lens.linear_cde.linear_d, lens.linear_cde.linear_e
        whole = c - d * e
        if abs(whole) < STRAIGHT:
            raise LensError(f"linear_cde of the f-theta camera cannot be inverted: c {c:g}, d {d:g}, e {e:g}")
        x, y = (x - d * y) / whole, (c * y - e * x) / whole
    widest_rad = lens.max_angle or math.pi
    if lens.reference_poly == FthetaCameraParam.PIXELDIST_TO_ANGLE:
        backward = list(lens.pixeldist_to_angle_poly)
        if not any(backward):
            raise LensError("the f-theta camera has no pixeldist_to_angle_poly, which its reference_poly names")

        def angle_of(away: NDArray[np.float64]) -> NDArray[np.float64]:
            angle = np.polynomial.polynomial.polyval(away, backward)
            return np.where((angle >= 0.0) & (angle <= widest_rad), angle, np.nan)

        return _turned(x, y, angle_of)
    forward = list(lens.angle_to_pixeldist_poly)
    if lens.reference_poly != FthetaCameraParam.ANGLE_TO_PIXELDIST or not any(forward):
        raise LensError("the f-theta camera has no reference_poly with a polynomial")
    return _turned(x, y, _inverse(lambda angle: np.polynomial.polynomial.polyval(angle, forward), widest_rad))


def _inverse(
    distance: Callable[[NDArray[np.float64]], NDArray[np.float64]], widest_rad: float
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Return the angle of a distance, NaN beyond the widest angle; the distance must rise with the angle."""
    angles: NDArray[np.float64] = np.linspace(0.0, min(widest_rad, math.pi), ANGLES, dtype=np.float64)
    away = distance(angles)
    rises = int(np.argmax(np.diff(away) <= 0.0)) if np.any(np.diff(away) <= 0.0) else len(away) - 1
    if rises < 1:
        raise LensError("the camera's polynomial does not rise with the angle, so a pixel has no direction")
    angles, away = angles[: rises + 1], away[: rises + 1].astype(np.float64)
    return lambda wanted: np.asarray(np.interp(wanted, away, angles, right=np.nan), dtype=np.float64)


def _turned(
    x: NDArray[np.float64], y: NDArray[np.float64], angle_of: Callable[[NDArray[np.float64]], NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return directions with the angle to the axis that ``angle_of`` gives each distance from the middle."""
    away = np.hypot(x, y)
    angle = angle_of(away)
    sideways = np.where(away > STRAIGHT, np.sin(angle) / np.maximum(away, STRAIGHT), 0.0)
    return _unit(x * sideways, y * sideways, np.cos(angle))


def _normalised(lens: object, u_px: NDArray[np.float64], v_px: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Return offsets from the principal point in focal lengths."""
    middle = getattr(lens, "principal_point_x"), getattr(lens, "principal_point_y")  # noqa: B009 - of either model
    focal = getattr(lens, "focal_length_x"), getattr(lens, "focal_length_y")  # noqa: B009 - as above
    if not all(length > 0.0 for length in focal):
        raise LensError(
            f"the focal lengths of the camera are {focal[0]:g} and {focal[1]:g} pixels; they must be above 0"
        )
    return (u_px - middle[0]) / focal[0], (v_px - middle[1]) / focal[1]


def _padded(values: Sequence[float], count: int) -> list[float]:
    """Return coefficients, with zeros for missing ones."""
    return [*values, *[0.0] * (count - len(values))]


def _unit(x: NDArray[np.float64], y: NDArray[np.float64], z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors of length 1; NaN where a coordinate is no finite number."""
    vectors = np.stack([x, y, z], axis=-1)
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(np.isfinite(length), vectors / length, np.nan)
