"""The tyre as PhysX has it: how far it slips, and how much it pushes for that, within its circle of friction.

Source: NVIDIA PhysX 3.4, PxVehicleUpdate.cpp (computeTireSlips, PxVehicleComputeTireForceDefault), which names the
CarSimEd manual, appendix F, "Michigan tire model". Unreal 4 lets PhysX compute its vehicles, and CARLA lets Unreal.
"""

import math

from linden.compiled import kernel

LEAST_ROLL_MPS = 0.1  # added to the speed that slip is sliding over, where a pedal acts: PhysX's 0.1 of its length
FREE_ROLL_MPS = 4.0  # the least such speed where none does: Unreal's setMinLongSlipDenominator
SIDEWAYS_MPS = 1.0  # added to the forward speed in the tangent of the slip angle: PhysX's gMinLatSpeedForTireModel
_LEAST_SLIP = 1e-5


@kernel
def brush_force(use: float) -> float:
    """Return the fraction of the friction limit that a brush tyre transmits.

    ``use``: stiffness times slip over the friction limit (dimensionless, >= 0); from 3 on the whole contact slides.
    Pacejka, Tire and Vehicle Dynamics, 3rd ed., eq. 3.14 (Fiala's parabola of pressure): use - use²/3 + use³/27.
    """
    if use >= 3.0:
        return 1.0
    return use * (1.0 - use * (1.0 / 3.0 - use * (1.0 / 27.0)))


@kernel
def cornering_stiffness(per_rad: float, full_load: float, load_n: float, rest_load_n: float) -> float:
    """Return N per unit of the slip angle's tangent: grows with the load, levels off at ``full_load`` times rest.

    The curve by which PhysX reads lat_stiff_value and lat_stiff_max_load: the parabola of :func:`brush_force` again,
    of three times the load over the one at which it saturates.
    """
    if rest_load_n <= 0.0:
        return 0.0
    return rest_load_n * per_rad * brush_force(3.0 * load_n / rest_load_n / full_load)


@kernel
def worked_slip(rolling_mps: float, along_mps: float) -> float:
    """Return the slip of a wheel on which throttle or brake acts.

    It is the sliding over the greater of its two speeds: that of its tread and that of its contact point.
    """
    return (rolling_mps - along_mps) / (max(abs(rolling_mps), abs(along_mps)) + LEAST_ROLL_MPS)


@kernel
def free_slip(rolling_mps: float, along_mps: float) -> float:
    """Return the slip of a wheel that merely rolls, which is kept from over-reacting when slow."""
    return (rolling_mps - along_mps) / max(FREE_ROLL_MPS, abs(rolling_mps), abs(along_mps))


@kernel
def slip_tangent(across_mps: float, along_mps: float) -> float:
    """Return the tangent of the slip angle."""
    return across_mps / (abs(along_mps) + SIDEWAYS_MPS)


@kernel
def tyre_push(slip: float, tangent: float, slip_n: float, cornering_n: float, limit_n: float) -> tuple[float, float]:
    """Return N along and across the wheel, together at most ``limit_n``.

    Both slips share one use of the contact; the force turns from the direction of the linear tyre, in which the two
    stiffnesses count, to that of the sliding as the use grows (to 2 pi, where the cosine is back).
    """
    if limit_n <= 0.0 or (abs(slip) < _LEAST_SLIP and abs(tangent) < _LEAST_SLIP):
        return 0.0, 0.0
    use = math.sqrt((cornering_n * tangent) ** 2 + (slip_n * slip) ** 2) / limit_n
    turn = 1.0
    if use <= 2.0 * math.pi:
        ratio = cornering_n / slip_n
        turn = 0.5 * (1.0 + ratio - (1.0 - ratio) * math.cos(0.5 * use))
    scale = limit_n * brush_force(use) / math.sqrt(slip * slip + (turn * tangent) ** 2)
    return slip * scale, -turn * tangent * scale
