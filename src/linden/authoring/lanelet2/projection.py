"""Latitude and longitude of a map's points by its own transverse Mercator projection, without a further library.

Formulas: Karney, Transverse Mercator with an accuracy of a few nanometers (J. Geodesy 85, 2011), equations 6 to 12 and
35 to 36, series to the fourth order (below 1 micrometre within 3,900 km). Ellipsoid: WGS84.
"""

import math
import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.errors import UserError

F64 = NDArray[np.float64]

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
_WORD = re.compile(r"\+([a-z_0-9]+)(?:=(\S+))?")


class Projection(NamedTuple):
    """A transverse Mercator projection on WGS84."""

    latitude_deg: float
    longitude_deg: float
    scale: float
    false_easting_m: float
    false_northing_m: float

    def degrees(self, x_m: F64, y_m: F64) -> tuple[F64, F64]:
        """Return latitude and longitude of points."""
        origin = _northing(np.array([math.radians(self.latitude_deg)]))[0]
        xi = (y_m - self.false_northing_m) / (self.scale * _RECTIFYING_M) + origin
        eta = (x_m - self.false_easting_m) / (self.scale * _RECTIFYING_M)
        xi_0, eta_0 = xi.copy(), eta.copy()
        for order, beta in enumerate(_BETA, start=1):
            xi_0 -= beta * np.sin(2 * order * xi) * np.cosh(2 * order * eta)
            eta_0 -= beta * np.cos(2 * order * xi) * np.sinh(2 * order * eta)
        conformal = np.sin(xi_0) / np.hypot(np.sinh(eta_0), np.cos(xi_0))
        longitude = np.arctan2(np.sinh(eta_0), np.cos(xi_0))
        return np.degrees(np.arctan(_geodetic(conformal))), np.degrees(longitude) + self.longitude_deg

    def metres(self, latitude_deg: F64, longitude_deg: F64) -> tuple[F64, F64]:
        """Return x and y of points."""
        origin = _northing(np.array([math.radians(self.latitude_deg)]))[0]
        conformal = _conformal(np.tan(np.radians(latitude_deg)))
        away = np.radians(longitude_deg - self.longitude_deg)
        xi_0 = np.arctan2(conformal, np.cos(away))
        eta_0 = np.arcsinh(np.sin(away) / np.hypot(conformal, np.cos(away)))
        xi, eta = xi_0.copy(), eta_0.copy()
        for order, alpha in enumerate(_ALPHA, start=1):
            xi += alpha * np.sin(2 * order * xi_0) * np.cosh(2 * order * eta_0)
            eta += alpha * np.cos(2 * order * xi_0) * np.sinh(2 * order * eta_0)
        size = self.scale * _RECTIFYING_M
        return size * eta + self.false_easting_m, size * (xi - origin) + self.false_northing_m


NOWHERE = Projection(0.0, 0.0, 1.0, 0.0, 0.0)
"""Of a map that does not say where it lies: its origin at latitude 0 and longitude 0, as CARLA's own towns have it."""


def projection_of(geo_reference: str) -> Projection | None:
    """Return the projection of the text of a <geoReference>; None where it is empty.

    Raises:
        UserError: the text names another kind of projection, or a number in it is none.
    """
    words = {key: value or "" for key, value in _WORD.findall(geo_reference)}
    if not geo_reference.strip():
        return None
    kind = words.get("proj", "")
    if kind == "utm":
        zone = _number(words, "zone", math.nan)
        if not 1 <= zone <= 60:
            raise UserError(f"the georeference {_short(geo_reference)!r} names no UTM zone from 1 to 60")
        south = "south" in words
        return Projection(0.0, 6.0 * zone - 183.0, 0.9996, 500000.0, 10000000.0 if south else 0.0)
    if kind != "tmerc":
        raise UserError(
            f"the georeference {_short(geo_reference)!r} is no transverse Mercator projection; "
            "write the map in +proj=tmerc or +proj=utm"
        )
    return Projection(
        _number(words, "lat_0", 0.0),
        _number(words, "lon_0", 0.0),
        _number(words, "k", _number(words, "k_0", 1.0)),
        _number(words, "x_0", 0.0),
        _number(words, "y_0", 0.0),
    )


def _number(words: dict[str, str], key: str, default: float) -> float:
    text = words.get(key, "")
    if not text:
        return default
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise UserError(f"the georeference has +{key}={text[:40]}; it should be a number")
    return value


def _short(text: str) -> str:
    return text.strip() if len(text.strip()) <= 60 else f"{text.strip()[:57]}..."


def _northing(latitude_rad: F64) -> F64:
    """Return the rectifying latitude on the central meridian."""
    xi_0 = np.arctan(_conformal(np.tan(latitude_rad)))
    xi = xi_0.copy()
    for order, alpha in enumerate(_ALPHA, start=1):
        xi += alpha * np.sin(2 * order * xi_0)
    return xi


def _conformal(tangent: F64) -> F64:
    """Return the tangent of the conformal latitude (equations 7 to 9)."""
    sigma = np.sinh(_E * np.arctanh(_E * tangent / np.hypot(1.0, tangent)))
    result: F64 = tangent * np.hypot(1.0, sigma) - sigma * np.hypot(1.0, tangent)
    return result


def _geodetic(conformal: F64) -> F64:
    """Return the tangent of the latitude by Newton's method (equations 19 to 21)."""
    tangent = conformal.copy()
    for _ in range(_NEWTON_STEPS):
        guess = _conformal(tangent)
        slope = (1.0 + (1.0 - _E**2) * tangent**2) / ((1.0 - _E**2) * np.hypot(1.0, tangent))
        tangent = tangent + (conformal - guess) / np.hypot(1.0, guess) * slope
    return tangent
