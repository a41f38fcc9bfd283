"""Suspension of a vehicle: height, pitch and roll follow the ground under the wheels like damped springs.

One spring for each of the three, solved by backward Euler, so a long step is only softer. The spring is as stiff as a
body that bounces at ``BOUNCE_RADPS``; a force only ever pushes up, so a vehicle can leave the ground and land again.
"""

import math

from linden.compiled import part
from linden.maps.ground import Ground, surface_under, triangle_under
from linden.physics.state import Body, Spec, Work

BOUNCE_RADPS = (
    10.0  # both as recorded: a car that is dropped settles so to half a millimetre (docs/explanation/fidelity.md)
)
DAMPING = 1.05  # of critical
DEEPEST_M = 0.15  # the bump stops: the body goes no deeper below its place
_HANGING_M = 1.0  # a wheel over an edge hangs this much below the highest, no lower
_STEEPEST_LEAN_RAD = 0.7


@part
def find_footing(v: Body, spec: Spec, w: Work, ground: Ground, cosine: float, sine: float) -> None:
    """Set ``footing``: height under the origin, pitch and roll of the plane through the ground under the wheels.

    ``cosine`` and ``sine`` are those of the yaw.
    """
    count = spec.wheel_count
    x, y, z = v.position[0], v.position[1], v.position[2]
    rising = math.sin(v.rotation[0])
    falling = math.sin(v.rotation[2]) if spec.track_m > 0.0 else 0.0  # the lean of a two-wheeler is not its ground's
    highest = -math.inf
    for k in range(count):
        ahead, right = spec.wheel_x_m[k], spec.wheel_y_m[k]
        hint = z + rising * ahead - falling * right
        wheel_x, wheel_y = x + cosine * ahead - sine * right, y + sine * ahead + cosine * right
        height, triangle = triangle_under(ground, wheel_x, wheel_y, hint)
        if triangle < 0:
            height, _, _, _, _ = surface_under(ground, wheel_x, wheel_y, hint)
        w.ground_m[k] = height
        highest = max(highest, height)
    half = count // 2
    front, rear, left, right_side = 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        height = max(w.ground_m[k], highest - _HANGING_M) / half
        front += height if k < half else 0.0
        rear += height if k >= half else 0.0
        left += height if spec.wheel_y_m[k] < 0.0 else 0.0
        right_side += height if spec.wheel_y_m[k] > 0.0 else 0.0
    rise = (front - rear) / spec.wheelbase_m
    fall = (left - right_side) / spec.track_m if spec.track_m > 0.0 else 0.0
    v.footing[0] = front - rise * spec.axle_front_m
    v.footing[1] = math.atan(rise)
    v.footing[2] = math.atan(fall / math.sqrt(1.0 + rise * rise))
    v.footing[3] = 1.0


@part
def settle(v: Body, spec: Spec, speed_x_mps: float, speed_y_mps: float, gravity_mps2: float, dt_s: float) -> None:
    """Advance height, pitch and roll towards the footing, the vehicle moving at these speeds forward and right."""
    rise, level = math.sin(v.footing[1]), math.cos(v.footing[1])
    ground_mps = rise * speed_x_mps - level * math.sin(v.footing[2]) * speed_y_mps
    fall = gravity_mps2 if v.gravity else 0.0
    stiff = 1.0 + 2.0 * DAMPING * BOUNCE_RADPS * dt_s + (BOUNCE_RADPS * dt_s) ** 2
    above = v.position[2] - v.footing[0]
    before = v.velocity[2]
    pushed = before + dt_s * (2.0 * DAMPING * BOUNCE_RADPS * ground_mps - BOUNCE_RADPS * BOUNCE_RADPS * above)
    rate = pushed / stiff
    support = fall + (rate - before) / dt_s
    if support <= 0.0:  # off the ground: free fall
        rate = before - fall * dt_s
        v.position[2] += 0.5 * (before + rate) * dt_s
        v.support_mps2 = 0.0
    else:
        v.position[2] += rate * dt_s
        v.support_mps2 = support * level * math.cos(v.footing[2])  # along the ground's normal
        if v.position[2] < v.footing[0] - DEEPEST_M:
            v.position[2] = v.footing[0] - DEEPEST_M
            rate = max(rate, ground_mps)
    v.velocity[2] = rate
    if v.support_mps2 > 0.0:
        _lean(v, spec, stiff, dt_s)
    else:
        v.rotation[0] += v.tilt_radps[0] * dt_s
        v.rotation[2] += v.tilt_radps[1] * dt_s


@part
def _lean(v: Body, spec: Spec, stiff: float, dt_s: float) -> None:
    """Advance pitch and roll: towards the ground's, squatting under thrust and leaning out of the bend.

    The angle under an acceleration a with the lever h is a h / (bounce² l²), of springs a mean l away from the centre
    of mass; Unreal's lever is how far below it the tyres push. A two-wheeler instead leans into the bend until weight
    and tyre force are in line with it.
    """
    lever = spec.sway_m / (BOUNCE_RADPS * BOUNCE_RADPS)
    pitch = v.footing[1] + lever * v.felt_mps2[0] / spec.pitch_arm2_m2
    if spec.track_m > 0.0:
        roll = v.footing[2] - lever * v.felt_mps2[1] / spec.roll_arm2_m2
    else:
        roll = v.footing[2] + math.atan(v.felt_mps2[1] / max(1.0, v.support_mps2))
    for axis, target in ((0, pitch), (1, roll)):
        angle = v.rotation[2 * axis]
        pushed = v.tilt_radps[axis] + dt_s * BOUNCE_RADPS * BOUNCE_RADPS * (target - angle)
        v.tilt_radps[axis] = pushed / stiff
        angle += v.tilt_radps[axis] * dt_s
        v.rotation[2 * axis] = max(-_STEEPEST_LEAN_RAD, min(_STEEPEST_LEAN_RAD, angle))
