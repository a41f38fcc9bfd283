"""The observation of one vehicle in numbers: the functions that `basu` calls and that `linden_gym` compiles.

They make no array, so that numba can compile them for a processor and for a GPU. All arrays have vehicles as their
first axis; ``k`` is the row of the vehicle. `basu.gym` describes shapes and units.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    F64 = NDArray[np.float64]
    F32 = NDArray[np.float32]

PREVIEW_POINTS, PREVIEW_M = 10, 5.0  # of the route ahead, and between them
OTHERS = 8  # road users in an observation
FASTEST_MPS, HARDEST_MPS2, FASTEST_TURN_RADPS = 40.0, 20.0, 4.0  # bounds of the boxes, beyond any shuttle's
FARTHEST_M = 60.0  # likewise, of places
TURN_RAD = math.pi + 1e-3  # likewise, of angles


class RouteColumns(NamedTuple):
    """A route of N points and S stop signs, and the box of the vehicle."""

    s_m: F64  # (N,)
    x_m: F64
    y_m: F64
    yaw_rad: F64  # without jumps of a whole turn
    signs_m: F64  # (S,) the places of their lines
    box_m: F64  # (2,) from the origin to the front, and half the length


class EgoRows(NamedTuple):
    """The motion of E vehicles under test: fields of `VehicleMotion`, each an array (E,)."""

    x_m: F64
    y_m: F64
    yaw_rad: F64
    velocity_x_mps: F64
    velocity_y_mps: F64
    velocity_z_mps: F64
    acceleration_x_mps2: F64
    acceleration_y_mps2: F64
    angular_velocity_z_radps: F64

    @property
    def speed_mps(self) -> F64:
        """(E,) speeds over ground."""
        speed_mps: F64 = np.sqrt(self.velocity_x_mps**2 + self.velocity_y_mps**2 + self.velocity_z_mps**2)
        return speed_mps

    @property
    def push_mps2(self) -> F64:
        """(E,) horizontal accelerations."""
        push_mps2: F64 = np.sqrt(self.acceleration_x_mps2**2 + self.acceleration_y_mps2**2)
        return push_mps2


class Places(NamedTuple):
    """Where E vehicles under test are on their route, and what holds there."""

    s_m: F64  # (E,) along the route
    lateral_m: F64  # (E,) off the route, positive to the right
    limit_mps: F64  # (E,) that is posted; 0 for none
    stopped: NDArray[np.bool_]  # (E, S) whether each has stopped at each sign until now


class Others(NamedTuple):
    """Road users near E vehicles under test, CARLA's frame."""

    rows: F64  # (E, K, 6) x, y, z, yaw, velocity x and y
    is_there: NDArray[np.bool_]  # (E, K) whether a row counts


class Views(NamedTuple):
    """Arrays with the observations of E vehicles, which `put_view` fills."""

    ego: F32  # (E, 6)
    route: F32  # (E, PREVIEW_POINTS, 2)
    others: F32  # (E, OTHERS, 6)
    stop_sign: F32  # (E, 2)


def bounded(value: float, most: float) -> float:
    """Return a number within -most..most; NaN stays."""
    if value > most:
        return most
    return -most if value < -most else value  # noqa: FURB136 - max() loses NaN once it is compiled


def turned(angle_rad: float) -> float:
    """Return an angle within -pi..pi."""
    return (angle_rad + math.pi) % math.tau - math.pi


def piece_at(at: float, columns: F64) -> int:
    """Return the index of the last of ascending numbers that is not above ``at``, but none of the last number."""
    low, high = 0, len(columns) - 1
    while high - low > 1:
        middle = (low + high) // 2
        if columns[middle] <= at:
            low = middle
        else:
            high = middle
    return low


def between(at: float, piece: int, places: F64, values: F64) -> float:
    """Return the value at a place, linear within a piece between two places and constant beyond their ends."""
    if at >= places[piece + 1]:
        return values[piece + 1]  # type: ignore[no-any-return] # a number
    if at <= places[piece]:
        return values[piece]  # type: ignore[no-any-return] # a number
    slope = (values[piece + 1] - values[piece]) / (places[piece + 1] - places[piece])
    return slope * (at - places[piece]) + values[piece]  # type: ignore[no-any-return] # a number


def put_view(
    k: int, route: RouteColumns, ego: EgoRows, places: Places, others: Others, away_m: F64, found: Views
) -> None:
    """Write the observation of one vehicle; ``away_m`` (OTHERS,) is room to work in."""
    cos, sin = math.cos(ego.yaw_rad[k]), math.sin(ego.yaw_rad[k])
    x_m, y_m, s_m = ego.x_m[k], ego.y_m[k], places.s_m[k]
    piece, last = piece_at(s_m, route.s_m), len(route.s_m) - 2
    heading = turned(ego.yaw_rad[k] - between(s_m, piece, route.s_m, route.yaw_rad))
    put_ego(k, ego, places, heading, cos, sin, found.ego)
    for point in range(PREVIEW_POINTS):
        at_m = s_m + PREVIEW_M * (point + 1)
        while piece < last and route.s_m[piece + 1] <= at_m:
            piece += 1
        to_x_m = between(at_m, piece, route.s_m, route.x_m) - x_m
        to_y_m = between(at_m, piece, route.s_m, route.y_m) - y_m
        found.route[k, point, 0] = bounded(to_x_m * cos + to_y_m * sin, FARTHEST_M)
        found.route[k, point, 1] = bounded(to_y_m * cos - to_x_m * sin, FARTHEST_M)
    put_others(k, ego, others, cos, sin, away_m, found.others)
    nearest_m = math.inf
    for sign in range(len(route.signs_m)):
        ahead_m = route.signs_m[sign] - (s_m + route.box_m[0])
        due = not places.stopped[k, sign] and -route.box_m[1] <= ahead_m <= FARTHEST_M
        if due and ahead_m < nearest_m:
            nearest_m = ahead_m
    there = nearest_m < math.inf
    found.stop_sign[k, 0] = 1.0 if there else 0.0
    found.stop_sign[k, 1] = nearest_m if there else 0.0


def put_ego(k: int, ego: EgoRows, places: Places, heading: float, cos: float, sin: float, found: F32) -> None:
    """Write the row of the vehicle itself: its ``heading`` is against the route, ``cos`` and ``sin`` are of its yaw."""
    vx_mps, vy_mps, vz_mps = ego.velocity_x_mps[k], ego.velocity_y_mps[k], ego.velocity_z_mps[k]
    forward_mps2 = ego.acceleration_x_mps2[k] * cos + ego.acceleration_y_mps2[k] * sin
    found[k, 0] = bounded(math.sqrt(vx_mps**2 + vy_mps**2 + vz_mps**2), FASTEST_MPS)
    found[k, 1] = bounded(forward_mps2, HARDEST_MPS2)
    found[k, 2] = bounded(ego.angular_velocity_z_radps[k], FASTEST_TURN_RADPS)
    found[k, 3] = bounded(places.lateral_m[k], FARTHEST_M)
    found[k, 4] = bounded(heading, TURN_RAD)
    found[k, 5] = bounded(places.limit_mps[k], FASTEST_MPS)


def put_others(k: int, ego: EgoRows, others: Others, cos: float, sin: float, away_m: F64, found: F32) -> None:
    """Write the rows of the nearest road users, the nearest first; those at the same distance keep their order."""
    for row in range(OTHERS):
        away_m[row] = math.inf
        for column in range(6):
            found[k, row, column] = 0.0
    for other in range(others.rows.shape[1]):
        if not others.is_there[k, other]:
            continue
        to_x_m, to_y_m = others.rows[k, other, 0] - ego.x_m[k], others.rows[k, other, 1] - ego.y_m[k]
        forward_m, right_m = to_x_m * cos + to_y_m * sin, to_y_m * cos - to_x_m * sin
        distance_m = math.sqrt(forward_m**2 + right_m**2)
        if not distance_m < away_m[OTHERS - 1]:
            continue
        row = OTHERS - 1
        while row > 0 and distance_m < away_m[row - 1]:
            away_m[row] = away_m[row - 1]
            for column in range(6):
                found[k, row, column] = found[k, row - 1, column]
            row -= 1
        away_m[row] = distance_m
        vx_mps, vy_mps = others.rows[k, other, 4], others.rows[k, other, 5]
        found[k, row, 0] = 1.0
        found[k, row, 1] = bounded(forward_m, FARTHEST_M)
        found[k, row, 2] = bounded(right_m, FARTHEST_M)
        found[k, row, 3] = bounded(turned(others.rows[k, other, 3] - ego.yaw_rad[k]), TURN_RAD)
        found[k, row, 4] = bounded(vx_mps * cos + vy_mps * sin, FASTEST_MPS)
        found[k, row, 5] = bounded(vy_mps * cos - vx_mps * sin, FASTEST_MPS)
