"""Acceleration and jerk at a standing passenger's place (`felt`); durations that require a step or grip (`balance`).

A standing passenger balances on a moving floor, so the measure is the specific force: acceleration of
the place of standing, less gravity, along the vehicle's axes. A slope is felt like a push, and in a bend the place
matters: the terms of the yaw acceleration and of the centripetal acceleration about the vehicle's origin are in it, as
are those of pitch and roll. Mechanics: Goldstein, Classical Mechanics, 3rd ed., sections 4.9 and 4.10.

Krašna, Keller, Linder, Silvano, Xu, Thomson and Klug 2021, "Human Response to Longitudinal Perturbations of Standing
Passengers on Public Transport During Regular Operation", Frontiers in Bioengineering and Biotechnology 9:680883, put 24
healthy volunteers of 34 +- 9 years without a handhold through two brakings of a bus: "For the two braking pulses
(1.0 and 2.5 m/s2), only the lower magnitude pulse allowed balance recovery without compensatory stepping." Karekla and
Tyler 2018, Safety Science 105, 128-133, chose 1.0, 1.5 and 2.5 m/s² as low, medium and high of what London's bus
passengers live through, and found control of balance to fall with each.

So above 1.0 a passenger without a handhold needs a balancing step, and room for it. Above 2.5 no study vouches for a
step, and only a handhold helps. Neither study states how strong a grip has to be: no share is claimed for passengers
with a handhold. Old people fall sooner than these volunteers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from basu.metrics.passengers.filters import lowpass, moving_mean

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from basu.records.history import History


GRAVITY_MPS2 = 9.80665  # standard gravity, ISO 80000-3
JERK_WINDOW_S = 0.5  # UN Regulation No. 79, 03 series: jerk is a 500 ms moving average of the filtered derivative


class PassengerPlace(NamedTuple):
    """Where a passenger stands: m from the vehicle's origin, which lies on the road under the middle of its box."""

    forward_m: float
    right_m: float
    up_m: float


# By the pole at the door of an EasyMile EZ10: at the front edge of the bay between the two benches, at the door's side,
# on a floor 0.3 m above the road. Estimated from the outer size (4.02 m by 2.00 m); no drawing of the inside was found.
STANDING = PassengerPlace(forward_m=0.7, right_m=0.5, up_m=0.3)


class Felt(NamedTuple):
    """All (T,), one value a frame; ``along`` is positive where one is pressed backwards, ``across`` to the left."""

    t_s: NDArray[np.float64]
    along_mps2: NDArray[np.float64]  # specific force forwards: negative in braking
    across_mps2: NDArray[np.float64]  # to the right: positive in a right-hand bend
    up_mps2: NDArray[np.float64]  # less that at rest on level ground
    filtered_along_mps2: NDArray[np.float64]  # of a body's reach: see `lowpass`
    filtered_across_mps2: NDArray[np.float64]
    jerk_along_mps3: NDArray[np.float64]  # change of the filtered acceleration, mean over 0.5 s
    jerk_across_mps3: NDArray[np.float64]
    speed_mps: NDArray[np.float64]  # along the vehicle, negative in reverse

    def horizontal_mps2(self) -> NDArray[np.float64]:
        """(T,) size of the filtered acceleration in the plane of the floor."""
        size: NDArray[np.float64] = np.hypot(self.filtered_along_mps2, self.filtered_across_mps2)
        return size


def felt(history: History, place: PassengerPlace = STANDING) -> Felt | None:
    """What is felt at ``place``, or None for a record of fewer than four frames: not measurable is not zero.

    Each acceleration is the mean over the step that ends with its frame, from the recorded velocities; the first frame
    repeats the second.
    """
    frames, step_s = history.frames, history.facts.step_s
    if len(frames) < 4:
        return None
    axes = _axes(frames["roll_rad"], frames["pitch_rad"], frames["yaw_rad"])
    velocity_mps = np.stack([frames[f"velocity_{axis}_mps"] for axis in "xyz"], axis=-1).astype(np.float64)
    force_mps2 = np.diff(velocity_mps, axis=0) / step_s + _lever(axes @ np.array(place), step_s)
    force_mps2[:, 2] += GRAVITY_MPS2
    middle = axes[1:] + axes[:-1]  # the axes halfway through each step, once they have length one
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    along, across, up = np.einsum("tij,ti->jt", middle, force_mps2)
    along, across, up = (np.concatenate([values[:1], values]) for values in (along, across, up - GRAVITY_MPS2))
    smooth_along, smooth_across = lowpass(along, step_s), lowpass(across, step_s)
    return Felt(
        t_s=frames["t_s"].astype(np.float64),
        along_mps2=along,
        across_mps2=across,
        up_mps2=up,
        filtered_along_mps2=smooth_along,
        filtered_across_mps2=smooth_across,
        jerk_along_mps3=_jerk(smooth_along, step_s),
        jerk_across_mps3=_jerk(smooth_across, step_s),
        speed_mps=np.einsum("ti,ti->t", axes[:, :, 0], velocity_mps),
    )


def _axes(
    roll_rad: NDArray[np.float64], pitch_rad: NDArray[np.float64], yaw_rad: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(T, 3, 3): columns are the vehicle's forward, right and up in the world.

    As CARLA turns (LibCarla, ``geom/Math.cpp``: GetForwardVector, GetRightVector, GetUpVector): a positive pitch lifts
    the nose, a positive roll lowers the right side, a positive yaw turns to the right.
    """
    cr, sr, cp, sp = np.cos(roll_rad), np.sin(roll_rad), np.cos(pitch_rad), np.sin(pitch_rad)
    cy, sy = np.cos(yaw_rad), np.sin(yaw_rad)
    forward = (cp * cy, cp * sy, sp)
    right = (cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, -cp * sr)
    up = (-cy * sp * cr - sy * sr, -sy * sp * cr + cy * sr, cp * cr)
    return np.stack([np.stack(axis, axis=-1) for axis in (forward, right, up)], axis=-1)


def _lever(arm_m: NDArray[np.float64], step_s: float) -> NDArray[np.float64]:
    """(T - 1, 3) acceleration of the place relative to the vehicle's origin, from the arm (T, 3) in the world.

    The second difference centred on the middle of each step, where the velocities' difference lies too. It holds the
    yaw, pitch and roll accelerations and the centripetal terms without asking which way a spin is counted.
    """
    inner = (arm_m[3:] - arm_m[2:-1] - arm_m[1:-2] + arm_m[:-3]) / (2.0 * step_s**2)
    return np.concatenate([inner[:1], inner, inner[-1:]])


def _jerk(filtered_mps2: NDArray[np.float64], step_s: float) -> NDArray[np.float64]:
    """(T,) change a second, mean over half a second around each frame."""
    return moving_mean(np.gradient(filtered_mps2, step_s), max(1, round(JERK_WINDOW_S / step_s)))


STEP_MPS2, GRIP_MPS2 = 1.0, 2.5
CREEP_MPS = 1.0  # slower than a slow walk: time at a creep counts by its way, so that it dilutes no share


class Balance(NamedTuple):
    """Times and shares count filtered horizontal acceleration at the passenger's place, in any direction."""

    moving_s: float  # the ride without its rests; time at a creep counts by its way
    step_s: float  # above STEP_MPS2
    step_share: float  # of the moving time
    grip_s: float  # above GRIP_MPS2
    grip_share: float
    worst_mps2: float
    worst_t_s: float


def balance(felt: Felt) -> Balance:
    """Count the time in which a passenger without a handhold needs a step, and in which a step is not enough."""
    size_mps2 = felt.horizontal_mps2()
    tick_s = float(felt.t_s[1] - felt.t_s[0])
    # a stop throws people when the vehicle stands already: what is felt at rest belongs to the ride
    moving_s = max(tick_s, float(np.minimum(np.abs(felt.speed_mps) / CREEP_MPS, 1.0).sum()) * tick_s)
    step_s, grip_s = (float(np.count_nonzero(size_mps2 > limit)) * tick_s for limit in (STEP_MPS2, GRIP_MPS2))
    worst = int(np.argmax(size_mps2))
    return Balance(
        moving_s=moving_s,
        step_s=step_s,
        step_share=min(1.0, step_s / moving_s),
        grip_s=grip_s,
        grip_share=min(1.0, grip_s / moving_s),
        worst_mps2=float(size_mps2[worst]),
        worst_t_s=float(felt.t_s[worst]),
    )
