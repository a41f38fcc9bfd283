"""The driver model: the rates at which pedals and steering wheel follow the control.

Unreal 4's WheeledVehicleMovementComponent lets its inputs follow the control once a frame, each at a rate of its own,
rising (away from zero) or falling; PhysX's PxVehicleDrive4WSmoothAnalogRawInputsAndSetAnalogInputs follows that once
more, at the same rates, every step, steering after it has been scaled by the steering curve. Recordings of CARLA are
met best with both (docs/explanation/fidelity.md).
"""

from linden.compiled import kernel, part
from linden.physics.state import Body, Spec
from linden.physics.vehicle.powertrain import on_curve

THROTTLE, STEER, BRAKE, HAND_BRAKE = range(4)
"""Places in the columns ``asked`` and ``given``."""

PEDAL_RISE, PEDAL_FALL = 6.0, 10.0  # per s, Unreal's defaults, as the next two pairs
HAND_BRAKE_RATE = 12.0
STEER_RISE, STEER_FALL = 2.5, 5.0


@kernel
def follow(now: float, target: float, rise: float, fall: float, dt_s: float) -> float:
    """Return where an input is after ``dt_s``: it moves by at most ``rise`` away from zero, ``fall`` towards it."""
    wanted = target - now
    rising = now == 0.0 or (wanted > 0.0) == (now > 0.0)
    most = dt_s * (rise if rising else fall)
    return now + max(-most, min(most, wanted))


@part
def let_go(v: Body) -> None:
    """Release pedals and wheel of a vehicle without sticky controls where no control came for this frame.

    As CARLA's AWheeledVehicleAIController does. There Ackermann control never acts on such a vehicle; here it does in
    the frame that it was sent for.
    """
    if not (v.controlled or v.sticky or v.autopilot):
        v.throttle, v.steer, v.brake = 0.0, 0.0, 0.0
        v.hand_brake, v.reverse, v.manual_gear_shift, v.ackermann_on = False, False, False, False
        v.gear_command = 0
    v.controlled = False


@part
def follow_control(v: Body, dt_s: float) -> None:
    """Let the inputs follow the control; once a frame."""
    asked = v.asked
    asked[THROTTLE] = follow(asked[THROTTLE], v.throttle, PEDAL_RISE, PEDAL_FALL, dt_s)
    asked[STEER] = follow(asked[STEER], v.steer, STEER_RISE, STEER_FALL, dt_s)
    asked[BRAKE] = follow(asked[BRAKE], v.brake, PEDAL_RISE, PEDAL_FALL, dt_s)
    pulled = 1.0 if v.hand_brake else 0.0
    asked[HAND_BRAKE] = follow(asked[HAND_BRAKE], pulled, HAND_BRAKE_RATE, HAND_BRAKE_RATE, dt_s)


@part
def follow_inputs(v: Body, spec: Spec, speed_mps: float, dt_s: float) -> None:
    """Let what engine, wheels and brakes get follow the inputs; every substep. The steering is less at speed."""
    fraction = on_curve(abs(speed_mps), spec.steering_mps, spec.steering_fraction, spec.steering_points)
    given, asked = v.given, v.asked
    given[THROTTLE] = follow(given[THROTTLE], asked[THROTTLE], PEDAL_RISE, PEDAL_FALL, dt_s)
    given[STEER] = follow(given[STEER], asked[STEER] * fraction, STEER_RISE, STEER_FALL, dt_s)
    given[BRAKE] = follow(given[BRAKE], asked[BRAKE], PEDAL_RISE, PEDAL_FALL, dt_s)
    given[HAND_BRAKE] = follow(given[HAND_BRAKE], asked[HAND_BRAKE], HAND_BRAKE_RATE, HAND_BRAKE_RATE, dt_s)
