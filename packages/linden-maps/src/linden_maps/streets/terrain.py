"""Ground heights from a file: a GeoTIFF, or the ground points of a LAS or LAZ file, as a grid in the map's metres.

A grid of heights is read between its nodes by bicubic (Catmull-Rom) interpolation, so that slopes have no steps.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pyproj import CRS, Proj, Transformer

from linden.errors import UserError
from linden_maps.streets.street_facts import Facts, Profile

F64 = NDArray[np.float64]

STEP_M = 4.0  # between nodes of the grid; streets do not bend more sharply up or down
MARGIN_M = 60.0  # of the grid beyond the streets: what junctions and turning circles need
MOST_NODES = 25_000_000
GROUND_CLASS = 2  # ASPRS LAS specification 1.4, table 9
_FEET = {"ft": 0.3048, "foot": 0.3048, "feet": 0.3048, "us survey foot": 1200.0 / 3937.0, "us-ft": 1200.0 / 3937.0}
_WEIGHTS = 0.5 * np.array([(0.0, 2.0, 0.0, 0.0), (-1, 0, 1, 0), (2, -5, 4, -1), (-1, 3, -3, 1)], np.float64)
"""Catmull-Rom's matrix: powers of the place between two nodes, by the four nodes about it."""


class Terrain(NamedTuple):
    """Heights (rows north, columns east) in m on a grid; ``corner_m`` is the first node's place."""

    heights_m: F64
    corner_m: tuple[float, float]
    step_m: float
    confidence: str
    profile: Profile = Profile(ramp_m=25.0, knot_m=12.0, steepest=0.15, steepest_spot=0.15, tilt=0.10)

    def height_m(self, x_m: float, y_m: float) -> float:
        """Return the height in m at a place; beyond the grid that of its edge."""
        return self._blend(x_m, y_m, (_powers, _powers))

    def rise(self, x_m: float, y_m: float) -> tuple[float, float]:
        """Return the rise per metre east and north at a place."""
        east = self._blend(x_m, y_m, (_slopes, _powers)) / self.step_m
        return east, self._blend(x_m, y_m, (_powers, _slopes)) / self.step_m

    def _blend(self, x_m: float, y_m: float, shares: tuple[Callable[[float], F64], Callable[[float], F64]]) -> float:
        column, across = self._cell(x_m - self.corner_m[0], self.heights_m.shape[1])
        row, along = self._cell(y_m - self.corner_m[1], self.heights_m.shape[0])
        nodes = self.heights_m[row - 1 : row + 3, column - 1 : column + 3]
        return float((shares[1](along) @ _WEIGHTS) @ nodes @ (shares[0](across) @ _WEIGHTS))

    def _cell(self, offset_m: float, count: int) -> tuple[int, float]:
        """Return the node before a place, with one more before it and two after it, and how far on the place lies."""
        at = min(max(offset_m / self.step_m, 1.0), count - 2.0 - 1e-9)
        return int(at), at - int(at)


def _powers(share: float) -> F64:
    return np.array([1.0, share, share**2, share**3])


def _slopes(share: float) -> F64:
    return np.array([0.0, 1.0, 2.0 * share, 3.0 * share**2])


def with_terrain(facts: Facts, file: Path) -> Facts:
    """Return the facts with the heights of a GeoTIFF (.tif) or of a LAS or LAZ file (.las, .laz) as their ground.

    Raises:
        UserError: the file cannot be read, says not where it lies, or does not cover the streets.
    """
    readers = {".tif": _of_geotiff, ".tiff": _of_geotiff, ".las": _of_las, ".laz": _of_las}
    reader = readers.get(file.suffix.lower())
    if reader is None:
        raise UserError(f"--elevation {file}: name a GeoTIFF (.tif), or a LAS or LAZ file (.las, .laz)")
    points = np.array([point for street in facts.streets for point in street.points])
    low, high = points.min(axis=0) - MARGIN_M, points.max(axis=0) + MARGIN_M
    columns, rows = (np.ceil((high - low) / STEP_M).astype(int) + 1).tolist()
    if columns * rows > MOST_NODES:
        raise UserError(f"the streets cover {columns * rows:,} cells of {STEP_M:g} m; build a smaller map")
    x_m, y_m = np.meshgrid(low[0] + STEP_M * np.arange(columns), low[1] + STEP_M * np.arange(rows))
    project = Proj(
        proj="tmerc", lat_0=facts.latitude_deg, lon_0=facts.longitude_deg, k=1, x_0=0, y_0=0, datum="WGS84", units="m"
    )
    heights_m = reader(file, x_m, y_m, project)
    corner_m = (float(low[0]), float(low[1]))
    return facts._replace(ground=Terrain(heights_m, corner_m, STEP_M, f"measured: {file.name}"))


def _of_geotiff(file: Path, x_m: F64, y_m: F64, project: Any) -> F64:  # noqa: ANN401 - of pyproj
    """Return the heights of a raster's first band at places, read between its cells' middles."""
    try:
        import rasterio  # noqa: PLC0415 - an optional part
    except ModuleNotFoundError:
        raise _missing("rasterio") from None
    try:
        with rasterio.open(file) as raster:
            if raster.crs is None:
                raise UserError(f"--elevation {file} has no coordinate reference system; georeference it first")
            band = raster.read(1, masked=True).astype(np.float64).filled(np.nan)
            inverse, crs, unit = ~raster.transform, CRS.from_wkt(raster.crs.to_wkt()), raster.units[0]
    except rasterio.errors.RasterioError as error:
        raise UserError(f"--elevation {file} cannot be read: {error}") from None
    longitude, latitude = project(x_m, y_m, inverse=True)
    east, north = Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(longitude, latitude)
    a, b, c, d, e, f = inverse[:6]
    column, row = (a * np.asarray(east) + b * np.asarray(north) + c, d * np.asarray(east) + e * np.asarray(north) + f)
    heights = _between(band, np.asarray(row) - 0.5, np.asarray(column) - 0.5) * _metres_per(unit)
    _check_cover(heights, latitude, longitude, file)
    return heights


def _between(band: F64, row: F64, column: F64) -> F64:
    """Return a band's values between the middles of its cells, bilinearly; NaN outside by more than half a cell."""
    rows, columns = band.shape
    outside = ~((row >= -0.5) & (row <= rows - 0.5) & (column >= -0.5) & (column <= columns - 0.5))
    row, column = (np.nan_to_num(np.clip(at, 0.0, last - 1.0)) for at, last in ((row, rows), (column, columns)))
    top, left = (np.minimum(at.astype(int), max(last - 2, 0)) for at, last in ((row, rows), (column, columns)))
    below, right = np.minimum(top + 1, rows - 1), np.minimum(left + 1, columns - 1)
    down, across = row - top, column - left
    found: F64 = (1 - down) * ((1 - across) * band[top, left] + across * band[top, right]) + down * (
        (1 - across) * band[below, left] + across * band[below, right]
    )
    return np.where(outside, np.nan, found)


def _of_las(file: Path, x_m: F64, y_m: F64, project: Any) -> F64:  # noqa: ANN401 - of pyproj
    """Return the mean height of the ground points in each cell; empty cells take the mean of their neighbours."""
    try:
        import laspy  # noqa: PLC0415 - an optional part
    except ModuleNotFoundError:
        raise _missing("laspy") from None
    try:
        las = laspy.read(file)
        crs = las.header.parse_crs()
    except (laspy.errors.LaspyException, OSError, ValueError) as error:
        raise UserError(f"--elevation {file} cannot be read: {error}") from None
    if crs is None:
        raise UserError(f"--elevation {file} has no coordinate reference system; georeference it first")
    classes = np.asarray(las.classification)
    is_ground = classes == GROUND_CLASS if (classes == GROUND_CLASS).any() else np.ones(len(classes), bool)
    flat = CRS(crs).sub_crs_list[0] if CRS(crs).is_compound else CRS(crs)
    places = np.asarray(las.x)[is_ground], np.asarray(las.y)[is_ground]
    east, north = project(*Transformer.from_crs(flat, "EPSG:4326", always_xy=True).transform(*places))
    heights = np.asarray(las.z)[is_ground]
    shape = x_m.shape
    column = np.round((east - x_m[0, 0]) / STEP_M).astype(int)
    row = np.round((north - y_m[0, 0]) / STEP_M).astype(int)
    inside = (column >= 0) & (column < shape[1]) & (row >= 0) & (row < shape[0])
    cells = row[inside] * shape[1] + column[inside]
    count = np.bincount(cells, minlength=x_m.size)
    total = np.bincount(cells, heights[inside], minlength=x_m.size)
    found = np.where(count > 0, total / np.maximum(count, 1), np.nan).reshape(shape)
    filled = _filled(found)
    longitude, latitude = project(x_m, y_m, inverse=True)
    _check_cover(filled, latitude, longitude, file)
    return filled


def _filled(heights: F64, rounds: int = 12) -> F64:
    """Return a grid with holes of up to ``2 * rounds`` cells across filled from their edges inwards."""
    found = heights.copy()
    for _ in range(rounds):
        holes = np.isnan(found)
        if not holes.any():
            break
        padded = np.pad(found, 1, constant_values=np.nan)
        around = np.stack([padded[1 + i : padded.shape[0] - 1 + i, 1 + j : padded.shape[1] - 1 + j]
                           for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j])  # fmt: skip
        known = ~np.isnan(around)
        mean = np.where(known, around, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        found = np.where(holes & known.any(axis=0), mean, found)
    return found


def _metres_per(unit: str | None) -> float:
    """Return the metres in a raster's unit; a raster without one is in metres, as most are."""
    return _FEET.get((unit or "").lower(), 1.0)


def _check_cover(heights: F64, latitude: F64, longitude: F64, file: Path) -> None:
    """Raise UserError where a height is missing: streets would float there."""
    missing = np.isnan(heights)
    if missing.any():
        row, column = np.argwhere(missing)[0]
        raise UserError(
            f"--elevation {file} has no height at latitude {np.asarray(latitude)[row, column]:.6f}, longitude "
            f"{np.asarray(longitude)[row, column]:.6f} ({100.0 * missing.mean():.0f} % of the ground under and "
            f"{MARGIN_M:g} m about the streets); take a file that covers them"
        )


def _missing(package: str) -> UserError:
    return UserError(f"--elevation needs the package {package}; install it with: pip install 'linden-maps[elevation]'")
