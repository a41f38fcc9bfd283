"""The tyre: how much it pushes for how much it slides, within its circle of friction."""

import math

from linden.compiled import kernel, part

SLOWEST_REFERENCE_MPS = 0.5
"""Slip is sliding over travelling speed; below this the latter is held, else a standing wheel would slip infinitely."""


@kernel
def brush_force(use: float) -> float:
    """Return the fraction of the friction limit that a brush tyre transmits.

    ``use``: stiffness times slip over the friction limit (dimensionless, >= 0); from 3 on the whole contact slides.
    Pacejka, Tire and Vehicle Dynamics, 3rd ed., eq. 3.14 (Fiala's parabola of pressure): use - use²/3 + use³/27.
    """
    if use >= 3.0:
        return 1.0
    return use * (1.0 - use * (1.0 / 3.0 - use * (1.0 / 27.0)))


@part
def _length(x: float, y: float) -> float:
    """Return the length of a vector; quicker than hypot, and forces stay far from its limits."""
    return math.sqrt(x * x + y * y)


@kernel
def cornering_stiffness(per_rad: float, full_load: float, load_n: float, rest_load_n: float) -> float:
    """Return N/rad: grows with the load and levels off at ``full_load`` times that at rest.

    The curve by which PhysX (CARLA's vehicles) reads lat_stiff_value and lat_stiff_max_load: the parabola of
    :func:`brush_force` again, of three times the load over the one at which it saturates.
    """
    if rest_load_n <= 0.0:
        return 0.0
    return rest_load_n * per_rad * brush_force(3.0 * load_n / rest_load_n / full_load)


@kernel
def secant_stiffness(
    slide_x_mps: float, slide_y_mps: float, travel_mps: float, slip_n: float, cornering_n: float, limit_n: float
) -> tuple[float, float]:
    """Return N·s/m along and across the wheel: force is these times the sliding speeds, at most ``limit_n`` together.

    Combined slip: Pacejka, 3rd ed., section 3.2.3, with different stiffness along and across; the force turns from
    the direction of the linear tyre to that of the sliding as the sliding zone (use -> 3) takes the whole contact.
    """
    if limit_n <= 0.0:
        return 0.0, 0.0
    reference_mps = max(abs(travel_mps), SLOWEST_REFERENCE_MPS)
    use = _length(slip_n * slide_x_mps, cornering_n * slide_y_mps) / (reference_mps * limit_n)
    if use < 1e-9:
        return slip_n / reference_mps, cornering_n / reference_mps
    turned = use * use * (1.0 / 9.0) if use < 3.0 else 1.0
    shift = 0.5 * turned * (cornering_n - slip_n)
    along, across = slip_n + shift, cornering_n - shift
    scale = limit_n * brush_force(use) / _length(along * slide_x_mps, across * slide_y_mps)
    return scale * along, scale * across
