"""The hands on the wheel: steers so that the vehicle's origin, between its axles, follows the path.

Kinematic bicycle (Rajamani, Vehicle Dynamics and Control, 2nd ed., section 2.2): the origin moves at the slip angle b
off the vehicle's axis, with tan b = (rear axle distance / wheelbase) tan(steer), and yaw turns by sin b / rear axle
distance per metre. Steering so that axis plus slip points along the path, turned in towards it by atan(e / length),
lets the offset e die out within a few ``length`` and the yaw follow by itself like a trailer's. It is Stanley's law
(Hoffmann et al. 2007, equation 5) with the origin in the place of the front axle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from basu.agents.builtin.driving.path import Path, Place
    from basu.agents.builtin.scene import Body

CATCH_M = 2.0  # an offset shrinks by e over this length at walking pace …
CATCH_S = 0.6  # … and over this time at speed
CALM_S = 0.3  # yaw errors are answered within this time at speed, at walking pace as the geometry has it
MAX_TURN_IN_RAD = 0.6  # towards the path, however far off


def steer_angle_rad(path: Path, place: Place, yaw_rad: float, speed_mps: float, body: Body, preview_s: float) -> float:
    """The front wheels' angle, positive to the right.

    Args:
        path: what to follow.
        place: where the origin is beside it.
        yaw_rad: of the vehicle, CARLA frame.
        speed_mps: along the vehicle's axis.
        body: axles.
        preview_s: how much later the angle takes effect; heading and curvature are read that much farther on.
    """
    ahead_s_m = place.s_m + max(speed_mps, 0.0) * preview_s
    heading_rad, curvature_1pm = path.heading_at_rad(ahead_s_m), path.curvature_at_1pm(ahead_s_m)
    rear_m = body.rear_axle_m
    steady_slip_rad = math.asin(max(-0.9, min(0.9, curvature_1pm * rear_m)))
    calm = rear_m / max(rear_m, CALM_S * speed_mps)
    catch_m = max(CATCH_M, CATCH_S * speed_mps)
    turn_in_rad = max(-MAX_TURN_IN_RAD, min(MAX_TURN_IN_RAD, math.atan(place.lateral_m / catch_m)))
    error_rad = math.remainder(heading_rad - turn_in_rad - yaw_rad, math.tau)
    slip_rad = steady_slip_rad + calm * (error_rad - steady_slip_rad)
    slip_rad = max(-1.2, min(1.2, slip_rad))
    return math.atan(body.wheelbase_m / rear_m * math.tan(slip_rad))
