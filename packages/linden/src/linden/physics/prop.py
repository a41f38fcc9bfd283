"""Props with a mass: boxes that slide over the ground with friction, and fall when nothing is under them."""

import math

from linden.compiled import part
from linden.maps.ground import Ground, surface_under
from linden.physics.axes import within_turn
from linden.physics.state import Body

SLIDING_FRICTION = 0.6
"""Wood or plastic on asphalt: between 0.5 and 0.7 in handbooks of accident reconstruction."""


@part
def advance_prop(v: Body, ground: Ground, gravity_mps2: float, dt_s: float) -> None:
    """Advance the prop ``v``: Coulomb friction on the ground, free fall above it. It does not tumble.

    One that lies still on the ground rests: it costs nothing until something moves it.
    """
    moves = v.velocity[0] != 0.0 or v.velocity[1] != 0.0 or v.velocity[2] != 0.0 or v.angular_velocity[2] != 0.0
    if v.resting and not moves:
        return
    v.resting = False
    fall = gravity_mps2 if v.gravity else 0.0
    bottom = v.position[2] + v.box_centre[2] - v.half_extent[2]
    below, _, _, _, _ = surface_under(ground, v.position[0], v.position[1], bottom)
    if bottom <= below + 1e-3 and v.velocity[2] <= 1e-6:
        speed = math.hypot(v.velocity[0], v.velocity[1])
        kept = max(0.0, 1.0 - SLIDING_FRICTION * fall * dt_s / speed) if speed > 0.0 else 0.0
        v.velocity[0] *= kept
        v.velocity[1] *= kept
        lever = math.hypot(v.half_extent[0], v.half_extent[1])
        slowed = SLIDING_FRICTION * fall * dt_s * 0.5 * lever * v.mass_kg / v.yaw_inertia_kgm2
        turn = v.angular_velocity[2]
        v.angular_velocity[2] = math.copysign(max(0.0, abs(turn) - slowed), turn)
        slides = v.velocity[0] != 0.0 or v.velocity[1] != 0.0 or v.angular_velocity[2] != 0.0
        v.resting = bottom >= below and fall > 0.0 and not slides
    after = v.velocity[2] - fall * dt_s
    moved = 0.5 * (v.velocity[2] + after) * dt_s
    v.position[0] += v.velocity[0] * dt_s
    v.position[1] += v.velocity[1] * dt_s
    v.rotation[1] = within_turn(v.rotation[1] + v.angular_velocity[2] * dt_s)
    if bottom + moved <= below:
        moved, after = below - bottom, 0.0
    v.position[2] += moved
    v.velocity[2] = after
