"""Impulses between two bodies that overlap, against approach and sliding, and a push out of each other.

Every impulse takes energy or leaves it: normal impulses only press, with a restitution below one; friction at most
stops the sliding. Guendelman et al. 2003, "Nonconvex rigid bodies with stacking", treats pairs in sequence likewise;
the formula of the impulse at a point is Mirtich 1996, eq. 3.18, in the plane.
"""

import math

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kept_part, part
from linden.physics.axes import body_axes
from linden.physics.contact.boxes import COS, HALF_X, HALF_Y, HIGH, LOW, SIN, X, Y, overlap
from linden.physics.contact.pairs import box_centre, is_fixed
from linden.physics.contact.statics import Statics
from linden.physics.state import SOURCES, VEHICLE, Body, Rows, Work

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

RESTITUTION = 0.1  # car bodies at town speeds: 0.05 to 0.2, Brach, Vehicle Accident Analysis and Reconstruction Methods
BOUNCES_FROM_MPS = 0.5  # slower contacts do not bounce
FRICTION = 0.4
CLEARANCE_M = 0.2  # what a vehicle's wheels roll over does not meet its body
_ROUNDS = 4
_SLOP_M = 0.005  # overlap that is left, so that resting contacts stay contacts
_PUSHED_OUT = 0.4  # of the rest, per step

JX, JY, JZ, PX, PY, PZ, TOUCHED, DEPTH, NX, NY, ACCOUNT = range(11)
"""Columns of the account kept per pair, and their number.

Impulse on the first body (N·s), last contact point (m), whether they met; then of the substep: depth, 0 where they are
apart (m), and normal.
"""


@kept_part(SOURCES)
def part_bodies(rows: Rows, pairs: I32, statics: Statics, w: Work, account: F64) -> None:
    """Find which pairs overlap, change velocities and positions of the movable, and enter it in ``account`` (P, 10)."""
    count = 0
    a, b = w.box, w.other_box
    for n in range(len(pairs)):
        account[n, DEPTH] = 0.0
        if _both_rest(rows, pairs[n, 0], pairs[n, 1]):
            continue
        _write_box(rows[pairs[n, 0]], a)
        _write_other(rows, pairs[n, 1], statics, b)
        _follow_slope(rows[pairs[n, 0]], a, b)
        if pairs[n, 1] >= 0:
            _follow_slope(rows[pairs[n, 1]], b, a)
        depth, normal_x, normal_y, x, y = overlap(a, b)
        if depth > 0.0:
            account[n, DEPTH], account[n, NX], account[n, NY] = depth, normal_x, normal_y
            account[n, PX], account[n, PY] = x, y
            account[n, PZ] = 0.5 * (max(a[LOW], b[LOW]) + min(a[HIGH], b[HIGH]))
            account[n, TOUCHED] = 1.0
            count += 1
    for turn in range(_ROUNDS if count > 1 else min(count, 2)):
        for n in range(len(pairs)):
            if account[n, DEPTH] > 0.0:
                _strike(rows, pairs[n], account[n], RESTITUTION if turn == 0 else 0.0)
    for n in range(len(pairs) if count > 0 else 0):
        if account[n, DEPTH] > 0.0:
            _push_out(rows, pairs[n], account[n])


@part
def _both_rest(rows: Rows, i: int, other: int) -> bool:
    """Tell whether neither of the two has moved since it came to rest."""
    return bool(rows[i].resting and (other < 0 or rows[other].resting or is_fixed(rows[other])))


@part
def _write_box(v: Body, box: F64) -> None:
    """Write a body's box; a vehicle's begins at its ground clearance, a tumbling one's is the upright box around it."""
    if v.tumbling:
        _write_tumbling(v, box)
        return
    box[X], box[Y] = box_centre(v)
    box[COS], box[SIN] = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    box[HALF_X], box[HALF_Y] = v.half_extent[0], v.half_extent[1]
    middle = v.position[2] + v.box_centre[2]
    box[LOW], box[HIGH] = middle - v.half_extent[2], middle + v.half_extent[2]
    if v.kind == VEHICLE:
        box[LOW] = max(box[LOW], v.position[2] + CLEARANCE_M)


@part
def _follow_slope(v: Body, box: F64, other: F64) -> None:
    """Raise or lower a body's box by the slope it stands on, where it is nearest to the other box.

    On a hill the road at the bumper is higher than under the middle, and so is what lies there for wheels to roll over.
    A vehicle's slope is that of the ground under its wheels: it does not hit more when it dives under the brakes.
    """
    if v.tumbling:
        return
    if v.kind == VEHICLE:
        rise, fall = math.tan(v.footing[1]), math.tan(v.footing[2])
    else:
        rise, fall = math.sin(v.rotation[0]), math.sin(v.rotation[2])
    away_x, away_y = other[X] - box[X], other[Y] - box[Y]
    ahead = max(-box[HALF_X], min(box[HALF_X], away_x * box[COS] + away_y * box[SIN]))
    right = max(-box[HALF_Y], min(box[HALF_Y], away_y * box[COS] - away_x * box[SIN]))
    higher = rise * ahead - fall * right
    box[LOW] += higher
    box[HIGH] += higher


@part
def _write_tumbling(v: Body, box: F64) -> None:
    """Write the upright box, turned as the nose is, that holds a body lying on its side or roof."""
    nose, side, up = body_axes(v.rotation[0], v.rotation[1], v.rotation[2])
    x, y, z = v.box_centre[0], v.box_centre[1], v.box_centre[2]
    box[X] = v.position[0] + nose[0] * x + side[0] * y + up[0] * z
    box[Y] = v.position[1] + nose[1] * x + side[1] * y + up[1] * z
    middle = v.position[2] + nose[2] * x + side[2] * y + up[2] * z
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    box[COS], box[SIN] = cosine, sine
    box[HALF_X], box[HALF_Y], high = 0.0, 0.0, 0.0
    for k in range(3):
        axis = nose if k == 0 else (side if k == 1 else up)
        box[HALF_X] += abs(axis[0] * cosine + axis[1] * sine) * v.half_extent[k]
        box[HALF_Y] += abs(axis[1] * cosine - axis[0] * sine) * v.half_extent[k]
        high += abs(axis[2]) * v.half_extent[k]
    box[LOW], box[HIGH] = middle - high, middle + high


@part
def _write_other(rows: Rows, other: int, statics: Statics, box: F64) -> None:
    """Write the box of a body, or of the static numbered -1 - ``other``."""
    if other >= 0:
        _write_box(rows[other], box)
        return
    n = -1 - other
    box[X], box[Y] = statics.centre[n, 0], statics.centre[n, 1]
    box[COS], box[SIN] = math.cos(statics.yaw_rad[n]), math.sin(statics.yaw_rad[n])
    box[HALF_X], box[HALF_Y] = statics.half[n, 0], statics.half[n, 1]
    box[LOW], box[HIGH] = statics.centre[n, 2] - statics.half[n, 2], statics.centre[n, 2] + statics.half[n, 2]


@part
def _ease(rows: Rows, i: int, x: float, y: float, along_x: float, along_y: float) -> float:
    """Return how much a unit impulse at a point moves that point, along the given direction: 1/kg; 0 for the fixed."""
    if i < 0 or is_fixed(rows[i]):
        return 0.0
    com_x, com_y = _centre(rows[i])
    lever = (x - com_x) * along_y - (y - com_y) * along_x
    return float(1.0 / rows[i].mass_kg + lever * lever / rows[i].yaw_inertia_kgm2)


@part
def _centre(v: Body) -> tuple[float, float]:
    """Return where the centre of mass is in the world, x and y in m."""
    cosine, sine = math.cos(v.rotation[1]), math.sin(v.rotation[1])
    ahead, right = v.centre_of_mass[0], v.centre_of_mass[1]
    return v.position[0] + cosine * ahead - sine * right, v.position[1] + sine * ahead + cosine * right


@part
def _point_speed(rows: Rows, i: int, x: float, y: float, along_x: float, along_y: float) -> float:
    """Return how fast the body's point at (x, y) moves along a direction, m/s; 0 for statics."""
    if i < 0:
        return 0.0
    turn = rows[i].angular_velocity[2]
    speed_x = rows[i].velocity[0] - turn * (y - rows[i].position[1])
    speed_y = rows[i].velocity[1] + turn * (x - rows[i].position[0])
    return float(speed_x * along_x + speed_y * along_y)


@part
def push_at(rows: Rows, i: int, x: float, y: float, impulse_x: float, impulse_y: float) -> None:
    """Change the motion of a movable body by an impulse (N·s) at a point of the world."""
    if i < 0 or is_fixed(rows[i]):
        return
    com_x, com_y = _centre(rows[i])
    turn = ((x - com_x) * impulse_y - (y - com_y) * impulse_x) / rows[i].yaw_inertia_kgm2
    rows[i].velocity[0] += impulse_x / rows[i].mass_kg + turn * (com_y - rows[i].position[1])
    rows[i].velocity[1] += impulse_y / rows[i].mass_kg - turn * (com_x - rows[i].position[0])
    rows[i].angular_velocity[2] += turn


@part
def _strike(rows: Rows, pair: I32, entry: F64, restitution: float) -> None:
    """Apply one contact's impulse: against approach along the normal, then against sliding across it."""
    i, j = pair[0], pair[1]
    normal_x, normal_y, x, y = entry[NX], entry[NY], entry[PX], entry[PY]
    approach = _point_speed(rows, i, x, y, normal_x, normal_y) - _point_speed(rows, j, x, y, normal_x, normal_y)
    if approach >= 0.0:
        return
    ease = _ease(rows, i, x, y, normal_x, normal_y) + _ease(rows, j, x, y, normal_x, normal_y)
    back = restitution if approach < -BOUNCES_FROM_MPS else 0.0
    press = -(1.0 + back) * approach / ease
    push_at(rows, i, x, y, press * normal_x, press * normal_y)
    push_at(rows, j, x, y, -press * normal_x, -press * normal_y)
    across_x, across_y = -normal_y, normal_x
    sliding = _point_speed(rows, i, x, y, across_x, across_y) - _point_speed(rows, j, x, y, across_x, across_y)
    ease = _ease(rows, i, x, y, across_x, across_y) + _ease(rows, j, x, y, across_x, across_y)
    rub = max(-FRICTION * press, min(FRICTION * press, -sliding / ease))
    push_at(rows, i, x, y, rub * across_x, rub * across_y)
    push_at(rows, j, x, y, -rub * across_x, -rub * across_y)
    entry[JX] += press * normal_x + rub * across_x
    entry[JY] += press * normal_y + rub * across_y


@part
def _push_out(rows: Rows, pair: I32, entry: F64) -> None:
    """Move two bodies out of each other along the normal, the lighter one further."""
    i, j = pair[0], pair[1]
    ease_i = 0.0 if is_fixed(rows[i]) else 1.0 / rows[i].mass_kg
    ease_j = 0.0 if j < 0 or is_fixed(rows[j]) else 1.0 / rows[j].mass_kg
    out_m = _PUSHED_OUT * max(0.0, entry[DEPTH] - _SLOP_M) / (ease_i + ease_j)
    if out_m == 0.0:
        return
    rows[i].position[0] += out_m * ease_i * entry[NX]
    rows[i].position[1] += out_m * ease_i * entry[NY]
    rows[i].resting = False
    if j >= 0:
        rows[j].position[0] -= out_m * ease_j * entry[NX]
        rows[j].position[1] -= out_m * ease_j * entry[NY]
        rows[j].resting = False
