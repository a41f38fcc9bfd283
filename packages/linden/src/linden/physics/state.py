"""The state of all bodies: the columns that the kernels read and write. Row = slot; SI units, radians, CARLA's frame.

The columns lie side by side in one numpy structured array, and so do the constants of the vehicles: numba compiles a
function of one array of records in a tenth of the time of one of sixty arrays, and calls it faster.
Columns without a unit in their name: position m, rotation (pitch, yaw, roll) rad, velocity m/s, angular_velocity rad/s
about the world's x, y, z, acceleration m/s², box_centre and half_extent m in the body's frame.
"""

from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from linden.compiled import fingerprint
from linden.structured import StructuredArray

Rows = StructuredArray
"""Array of BODY (N,), or of VEHICLE_SPEC (N,)."""
Body: TypeAlias = Any
"""One record of BODY, as kernels see it."""
Spec: TypeAlias = Any
"""One record of VEHICLE_SPEC, as kernels see it."""
Work: TypeAlias = Any
"""One record of VEHICLE_WORK, as kernels see it."""

_HERE = Path(__file__).parent
_WITH_KERNELS = [path for path in _HERE.rglob("*.py") if b"linden.compiled" in path.read_bytes()]
SOURCES = fingerprint(*_WITH_KERNELS, _HERE.parent / "maps" / "ground.py")
"""Of all files with kernels of the physics, this one included: what is compiled across them is renewed with any."""

NO_BODY, VEHICLE, WALKER, PROP = range(4)
"""Values of the column ``kind``."""

WHEELS = 4
TUMBLING_POINTS = 16
"""Points of a body off its wheels that can meet the ground, see ``tumble``."""
CURVE_POINTS = 32
GEARS = 16

VEHICLE_SPEC = np.dtype(
    [
        ("wheel_count", "i4"),
        ("wheel_x_m", "f8", WHEELS),  # of the contact point, forward of the actor's origin
        ("wheel_y_m", "f8", WHEELS),  # and to its right
        ("wheel_radius_m", "f8", WHEELS),
        ("wheel_inertia_kgm2", "f8", WHEELS),
        ("wheel_damping_nms", "f8", WHEELS),
        ("friction", "f8", WHEELS),  # of the tyre alone; the road's is added by vehicle.wheels
        ("cornering_per_rad", "f8", WHEELS),  # cornering stiffness over the wheel's load at rest
        ("cornering_full_load", "f8", WHEELS),  # load over that at rest beyond which cornering stiffness grows no more
        ("slip_stiffness_n", "f8", WHEELS),  # longitudinal force per unit of slip
        ("steer_max_rad", "f8", WHEELS),
        ("brake_nm", "f8", WHEELS),
        ("hand_brake_nm", "f8", WHEELS),
        ("drive_share", "f8", WHEELS),  # of the axle torque while no wheel slips; adds up to 1
        ("load_share", "f8", WHEELS),  # of the weight at rest on the flat; adds up to 1
        ("tyres_lag", "u1"),  # whether wheels turn by the tyres' torque of the moment before, as PhysX has it
        ("wheelbase_m", "f8"),
        ("track_m", "f8"),  # 0 for a two-wheeler
        ("axle_front_m", "f8"),
        ("axle_rear_m", "f8"),
        ("sway_m", "f8"),  # how far below the centre of mass the tyres' forces act: what the body leans by
        ("pitch_arm2_m2", "f8"),  # mean square of the wheels' distance from the centre of mass, weighted by load
        ("roll_arm2_m2", "f8"),
        ("drag_kgpm", "f8"),  # force over the square of the speed
        ("engine_inertia_kgm2", "f8"),
        ("engine_max_radps", "f8"),
        ("damping_full_throttle", "f8"),  # N·m·s/rad, as the next two
        ("damping_engaged", "f8"),
        ("damping_disengaged", "f8"),
        ("clutch_nms", "f8"),
        ("switch_time_s", "f8"),
        ("autobox", "u1"),
        ("gear_count", "i4"),
        ("gear_ratio", "f8", GEARS),  # axle turns into engine turns, final drive included
        ("reverse_ratio", "f8"),  # likewise; negative
        ("gear_down", "f8", GEARS),  # of the engine's greatest speed
        ("gear_up", "f8", GEARS),
        ("torque_points", "i4"),
        ("torque_radps", "f8", CURVE_POINTS),
        ("torque_nm", "f8", CURVE_POINTS),
        ("steering_points", "i4"),
        ("steering_mps", "f8", CURVE_POINTS),
        ("steering_fraction", "f8", CURVE_POINTS),
    ],
    align=True,
)
"""What a vehicle is, one record a slot, made from CARLA's VehiclePhysicsControl by ``vehicle.parameters``."""


BODY = np.dtype(
    [
        ("alive", "?"),
        ("kind", "u1"),
        ("simulate", "?"),
        ("gravity", "?"),
        ("collides", "?"),
        ("immovable", "?"),  # a prop without mass
        ("position", "f8", 3),
        ("rotation", "f8", 3),
        ("velocity", "f8", 3),  # of the actor's origin
        ("angular_velocity", "f8", 3),
        ("acceleration", "f8", 3),
        ("box_centre", "f8", 3),
        ("half_extent", "f8", 3),
        ("mass_kg", "f8"),
        ("yaw_inertia_kgm2", "f8"),  # inf for what no push can turn (walkers)
        ("centre_of_mass", "f8", 3),  # m, in the body's frame
        ("throttle", "f8"),
        ("steer", "f8"),
        ("brake", "f8"),
        ("hand_brake", "?"),
        ("reverse", "?"),
        ("manual_gear_shift", "?"),
        ("gear_command", "i4"),
        ("sticky", "?"),  # whether a control stays until the next; else it is that of one frame
        ("autopilot", "?"),  # a client's Traffic Manager drives: its controls stay
        ("controlled", "?"),  # since the last frame
        ("gear", "i4"),  # engaged now: 0 while changing
        ("engine_rpm", "f8"),
        ("wheel_omega", "f8", WHEELS),  # rad/s, positive forward
        ("wheel_steer", "f8", WHEELS),  # rad, positive to the right
        ("wheel_turned", "f8", WHEELS),  # rad, how far it has rolled forward, in [-pi, pi)
        ("wheel_long_slip", "f8", WHEELS),
        ("wheel_lat_slip", "f8", WHEELS),  # rad
        ("wheel_load", "f8", WHEELS),  # N, as the next two
        ("wheel_long_force", "f8", WHEELS),
        ("wheel_lat_force", "f8", WHEELS),
        ("wheel_torque", "f8", WHEELS),  # N·m of engine less brake
        ("walker_direction", "f8", 3),
        ("walker_speed", "f8"),
        ("jump", "?"),
        ("road_friction", "f8"),  # of the road's state: 1 dry; what the tyres' friction is multiplied with
        ("friction_here", "f8"),  # tyre friction that a trigger imposes, below 0 where there is none
        ("failure", "u1"),  # values.enums.VehicleFailureState
        # from here on: the kernels' memory
        ("heave_mps", "f8"),  # vertical speed beside that of the motion in the plane of the road
        ("tilt_radps", "f8", 2),  # rates of pitch and roll
        ("footing", "f8", 4),  # of the ground under the wheels: height m, pitch rad, roll rad, 1 where known
        ("felt_mps2", "f8", 2),  # force of the tyres over mass, forward and right: what the body leans under
        ("asked", "f8", 4),  # throttle, steer, brake and hand brake as far as they have followed the driver
        ("given", "f8", 4),  # and as they have followed that: what engine, wheels and brakes get
        ("since_shift_s", "f8"),  # since the automatic last began to change
        ("slow_s", "f8"),  # for how long the wheels have all but stood without throttle
        ("support_mps2", "f8"),  # force of the ground over mass
        ("target_gear", "i4"),
        ("shift_left_s", "f8"),
        ("was_reverse", "?"),
        ("resting", "?"),  # nothing has moved, nothing will until an input changes
        ("still_s", "f8"),  # for how long springs and wheels have been still
        ("rest_input", "f8", 6),  # the inputs it rests under
        ("jump_pending", "?"),
        ("tumbling", "?"),  # a vehicle off its wheels: a rigid body in space until it stands again
        ("rollover_stage", "u1"),  # how far over it has gone, see vehicle.rollover
        ("rollover_s", "f8"),  # since it lay on its roof
        ("impulse", "f8", 3),  # N·s, once
        ("angular_impulse", "f8", 3),  # N·m·s, once
        ("force", "f8", 3),  # N, during the next advance
        ("torque", "f8", 3),  # N·m, likewise
        ("constant_velocity_on", "?"),
        ("constant_velocity", "f8", 3),  # m/s in the body's frame
        ("ackermann_on", "?"),
        ("ackermann", "f8", 5),  # the target; as linden.protocol.values.AckermannControl
        ("ackermann_gains", "f8", 6),
        ("ackermann_memory", "f8", 8),  # of its two controllers
    ],
    align=True,
)
"""What a body does, one record a slot."""


VEHICLE_WORK = np.dtype(
    [
        # of the wheels, fixed for a substep
        ("limit_n", "f8", WHEELS),  # of friction
        ("cornering_n", "f8", WHEELS),  # stiffness to the tangent of the slip angle, N
        ("cosine", "f8", WHEELS),  # of the steering angle
        ("sine", "f8", WHEELS),
        ("along_turn_m", "f8", WHEELS),  # what a yaw rate adds to the contact's speed along the wheel
        ("across_turn_m", "f8", WHEELS),  # and across it
        ("brake_nm", "f8", WHEELS),
        ("spin_nms", "f8", WHEELS),  # inertia over the step, N·m/(rad/s)
        ("drag_nms", "f8", WHEELS),  # that and the wheel's damping
        # of the wheels, now
        ("along_mps", "f8", WHEELS),  # speed of the contact along the wheel
        ("across_mps", "f8", WHEELS),
        ("slip", "f8", WHEELS),  # longitudinal
        ("push_x_n", "f8", WHEELS),  # on the body, along the wheel
        ("push_y_n", "f8", WHEELS),  # and across it
        ("share", "f8", WHEELS),  # of the clutch's torque
        ("grip_nspm", "f8", WHEELS),  # what the tyre's push grows by with its sliding; 0 where the tyre lags
        ("ease", "f8", WHEELS),  # one over the resistance to a change of spin, rad/s/(N·m)
        ("free_nm", "f8", WHEELS),  # torque without drive and brake
        # of the driver
        ("wants_to_go", "?"),  # throttle without brakes, in gear
        ("hand_braked", "?"),
        # of the body
        ("speeds", "f8", 3),  # the motion: m/s forward, m/s to the right, rad/s
        ("pull", "f8", 3),  # outer forces: N, N, N·m; gravity's part along the slope included
        ("ground_m", "f8", WHEELS),  # height under each wheel
        # of a body off its wheels
        ("axes", "f8", (3, 3)),  # its axes as columns, in the world
        ("arm", "f8", 3),  # of the centre of mass from the origin, m
        ("weight", "f8", (3, 3)),  # inverse of the inertia, in the world
        ("turn_ease", "f8", 3),  # and about its own axes, over the mass
        ("turn", "f8", 3),  # spin, rad/s
        ("speed", "f8", 3),  # of the centre of mass, m/s
        ("local", "f8", 3),  # a point in the body's frame, m
        ("at", "f8", 3),  # and from the centre of mass, in the world
        ("points", "f8", (TUMBLING_POINTS, 9)),  # arm, normal, allowed approach, friction along and across
        ("given_ns", "f8", (TUMBLING_POINTS, 3)),  # impulses on each: normal, along, across
        ("along", "f8", 3),  # a direction
        ("lever", "f8", 3),
        ("middle", "f8", 3),  # the centre of mass, m
        # of a contact: the boxes of the two, see ``contact.boxes``
        ("box", "f8", 8),
        ("other_box", "f8", 8),
    ],
    align=True,
)
"""What is worked out for the body at hand: scratch. A record, since numba counts references to arrays, not to it.

On a GPU a kernel can allocate no arrays."""
