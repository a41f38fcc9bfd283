"""Transverse Mercator by its series, without PROJ: the slow and obvious version that map making must agree with.

Formulas: Karney, Transverse Mercator with an accuracy of a few nanometers (J. Geodesy 85, 2011), equations 6 to 12 and
35 to 36, series to the fourth order (below 1 micrometre within 3,900 km). Ellipsoid: WGS84.
"""

import math

import numpy as np

_A_M = 6378137.0
_F = 1.0 / 298.257223563
_N = _F / (2.0 - _F)
_E = math.sqrt(_F * (2.0 - _F))
_RECTIFYING_M = _A_M / (1.0 + _N) * (1.0 + _N**2 / 4.0 + _N**4 / 64.0)
_ALPHA = (
    _N / 2 - 2 * _N**2 / 3 + 5 * _N**3 / 16 + 41 * _N**4 / 180,
    13 * _N**2 / 48 - 3 * _N**3 / 5 + 557 * _N**4 / 1440,
    61 * _N**3 / 240 - 103 * _N**4 / 140,
    49561 * _N**4 / 161280,
)
_BETA = (
    _N / 2 - 2 * _N**2 / 3 + 37 * _N**3 / 96 - _N**4 / 360,
    _N**2 / 48 + _N**3 / 15 - 437 * _N**4 / 1440,
    17 * _N**3 / 480 - 37 * _N**4 / 840,
    4397 * _N**4 / 161280,
)
_NEWTON_STEPS = 5


def degrees(origin_deg, scale, false_m, x_m, y_m):
    """Return latitude and longitude of points; origin and false place are pairs."""
    origin = northing(np.array([math.radians(origin_deg[0])]))[0]
    xi = (y_m - false_m[1]) / (scale * _RECTIFYING_M) + origin
    eta = (x_m - false_m[0]) / (scale * _RECTIFYING_M)
    xi_0, eta_0 = xi.copy(), eta.copy()
    for order, beta in enumerate(_BETA, start=1):
        xi_0 -= beta * np.sin(2 * order * xi) * np.cosh(2 * order * eta)
        eta_0 -= beta * np.cos(2 * order * xi) * np.sinh(2 * order * eta)
    conformal = np.sin(xi_0) / np.hypot(np.sinh(eta_0), np.cos(xi_0))
    longitude = np.arctan2(np.sinh(eta_0), np.cos(xi_0))
    return np.degrees(np.arctan(geodetic(conformal))), np.degrees(longitude) + origin_deg[1]


def northing(latitude_rad):
    """Return the rectifying latitude on the central meridian."""
    xi_0 = np.arctan(conformal_tangent(np.tan(latitude_rad)))
    xi = xi_0.copy()
    for order, alpha in enumerate(_ALPHA, start=1):
        xi += alpha * np.sin(2 * order * xi_0)
    return xi


def conformal_tangent(tangent):
    """Return the tangent of the conformal latitude (equations 7 to 9)."""
    sigma = np.sinh(_E * np.arctanh(_E * tangent / np.hypot(1.0, tangent)))
    return tangent * np.hypot(1.0, sigma) - sigma * np.hypot(1.0, tangent)


def geodetic(conformal):
    """Return the tangent of the latitude by Newton's method (equations 19 to 21)."""
    tangent = conformal.copy()
    for _ in range(_NEWTON_STEPS):
        guess = conformal_tangent(tangent)
        slope = (1.0 + (1.0 - _E**2) * tangent**2) / ((1.0 - _E**2) * np.hypot(1.0, tangent))
        tangent = tangent + (conformal - guess) / np.hypot(1.0, guess) * slope
    return tangent
