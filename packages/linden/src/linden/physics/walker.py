"""Walkers: motion in the direction and at the speed of their control, on ground that they can step onto."""

import math

from linden.compiled import part
from linden.maps.ground import Ground, surface_under
from linden.physics.axes import within_turn
from linden.physics.state import Body

ACCELERATION_MPS2 = 8.0  # from a stand to a walk (1.4 m/s) in 0.2 s; what a push gives is lost at the same rate
JUMP_MPS = 4.2  # Unreal's character: JumpZVelocity 420 cm/s
STEP_UP_M = 0.45  # Unreal's character: MaxStepHeight 45 cm
_LEAST_UPRIGHT = 0.71  # Unreal's character: WalkableFloorZ, a slope of 45 degrees


@part
def advance_walker(v: Body, ground: Ground, gravity_mps2: float, dt_s: float) -> None:
    """Advance the walker ``v``; its origin is the middle of the body, half its height over its feet."""
    half = v.half_extent[2] - v.box_centre[2]
    feet = v.position[2] - half
    below, _, _, _, _ = surface_under(ground, v.position[0], v.position[1], feet)
    standing = feet <= below + 1e-3 and v.velocity[2] <= 1e-6
    if standing:
        if not v.constant_velocity_on:
            _walk(v, dt_s)
        if v.jump_pending:
            v.velocity[2] = JUMP_MPS
            standing = False
    v.jump_pending = False
    step_x, step_y = v.velocity[0] * dt_s, v.velocity[1] * dt_s
    ahead, _, _, upright, _ = surface_under(ground, v.position[0] + step_x, v.position[1] + step_y, feet)
    if ahead - feet > STEP_UP_M or (ahead > below and upright < _LEAST_UPRIGHT):
        v.velocity[0], v.velocity[1] = 0.0, 0.0
        ahead = below
    else:
        v.position[0] += step_x
        v.position[1] += step_y
    if standing and feet - ahead <= STEP_UP_M:  # what is a step down is stepped down
        v.position[2], v.velocity[2] = ahead + half, 0.0
    else:
        _fall(v, ahead + half, gravity_mps2 if v.gravity else 0.0, dt_s)


@part
def _walk(v: Body, dt_s: float) -> None:
    """Bring the velocity towards what is wanted and turn the body to where it goes; a direction longer than 1 is 1."""
    x, y = v.walker_direction[0], v.walker_direction[1]
    length = math.hypot(x, y)
    wanted = v.walker_speed / max(1.0, length)
    gain_x, gain_y = x * wanted - v.velocity[0], y * wanted - v.velocity[1]
    gain = math.hypot(gain_x, gain_y)
    share = min(1.0, ACCELERATION_MPS2 * dt_s / gain) if gain > 0.0 else 0.0
    v.velocity[0] += share * gain_x
    v.velocity[1] += share * gain_y
    if wanted * length > 1e-6:
        v.rotation[1] = within_turn(math.atan2(y, x))


@part
def _fall(v: Body, lowest_m: float, fall_mps2: float, dt_s: float) -> None:
    """Let the body fall freely, its origin no lower than ``lowest_m``."""
    after = v.velocity[2] - fall_mps2 * dt_s
    z = v.position[2] + 0.5 * (v.velocity[2] + after) * dt_s
    if z <= lowest_m:
        z, after = lowest_m, 0.0
    v.position[2], v.velocity[2] = z, after
