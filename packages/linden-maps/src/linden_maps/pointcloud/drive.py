"""The drive with a lidar: measuring places along the driving lanes, and the scans made there.

No two places are nearer to each other than a given distance. The drive runs in one process, without a client. It uses
the lidar's rays and the ray caster as a server's sensor does. No time passes within a scan, so nothing is smeared.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from linden.geometry import from_opendrive
from linden.maps.opendrive.evaluate.tables import tables_of
from linden.maps.opendrive.model import OpenDrive
from linden.protocol.values.enums import LaneType
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.mesh import Mesh
from linden.sensors.casting.caster import Caster
from linden.sensors.devices.lidar.firing_pattern import Fan, aim, fire
from linden_maps.pointcloud.cloud import F64, Cloud, Scan

_BLOCK_M = 200.0
"""Places are visited block by block, so that what is near to one another is measured one after the other."""


class SensorPlace(NamedTuple):
    """A level sensor in the map's frame."""

    x_m: float
    y_m: float
    z_m: float
    heading_rad: float

    @property
    def map_from_sensor(self) -> F64:
        """The pose (3, 4)."""
        c, s = math.cos(self.heading_rad), math.sin(self.heading_rad)
        return np.array([[c, -s, 0.0, self.x_m], [s, c, 0.0, self.y_m], [0.0, 0.0, 1.0, self.z_m]])

    @property
    def transform(self) -> Transform:
        """The same in CARLA's frame."""
        return from_opendrive(self.x_m, self.y_m, self.z_m, self.heading_rad)


def places_along(opendrive: OpenDrive, every_m: float, height_m: float) -> list[SensorPlace]:
    """Return places in the middle of the driving lanes, ``height_m`` above them.

    Every point of such a lane has a place within ``every_m`` or a little more, and no two places are nearer to each
    other than that: one drive serves both directions of a narrow street, and the many ways across a junction.
    """
    candidates = _candidates(opendrive, 0.5 * every_m)
    kept = _thinned(candidates, every_m)
    block = np.floor(kept[:, :2] / _BLOCK_M).astype(np.int64)
    back = block[:, 0] % 2 == 1  # there northwards, back southwards
    order = np.lexsort((np.where(back, -block[:, 1], block[:, 1]), block[:, 0]))
    return [SensorPlace(x, y, z + height_m, heading) for x, y, z, heading in kept[order].tolist()]


def _candidates(opendrive: OpenDrive, step_m: float) -> F64:
    """Return (N, 4) of x, y, z, heading along all driving lanes, road after road, the roads of junctions last."""
    tables = tables_of(opendrive)
    lanes, s_m = list[int](), list[F64]()
    for is_in_junction in (False, True):
        for row, value in enumerate(tables.lane_values):
            lane = tables.lanes[row]
            if value.type is not LaneType.DRIVING or tables.roads[lane["road"]].is_in_junction is not is_in_junction:
                continue
            length_m = float(lane["end_m"] - lane["start_m"])
            count = max(1, math.ceil(length_m / step_m))
            s_m.append(float(lane["start_m"]) + length_m * (np.arange(count) + 0.5) / count)
            lanes += [row] * count
    rows = np.array(lanes, np.int64)
    middle = tables.lane_centres(rows, np.concatenate([np.empty(0), *s_m]))
    return np.stack([middle.x_m, middle.y_m, middle.z_m, middle.heading_rad], axis=1)


def _thinned(candidates: F64, apart_m: float) -> F64:
    """Return the candidates that are not too near to one before them in the list."""
    taken: dict[tuple[int, int], list[list[float]]] = {}
    kept = []
    for row, at in enumerate(candidates[:, :3].tolist()):
        column, line = math.floor(at[0] / apart_m), math.floor(at[1] / apart_m)
        near = (
            other
            for x in (column - 1, column, column + 1)
            for y in (line - 1, line, line + 1)
            for other in taken.get((x, y), ())
        )
        if all(math.dist(at, other) >= apart_m for other in near):
            taken.setdefault((column, line), []).append(at)
            kept.append(row)
    return candidates[kept]


_TURN_HZ = 10.0  # any: a scan is one whole turn, and takes no time


class Lidar(NamedTuple):
    """A lidar that is level and looks all around; the names of its parts are those of CARLA's attributes."""

    channels: int = 64
    upper_fov_deg: float = 15.0
    lower_fov_deg: float = -25.0
    range_m: float = 100.0
    columns: int = 1800  # rays of a channel in one turn

    @property
    def fan(self) -> Fan:
        """The same as the server's lidars have it."""
        points_per_s = self.channels * self.columns * int(_TURN_HZ)
        edges = (self.upper_fov_deg, self.lower_fov_deg)
        return Fan(self.channels, *edges, 360.0, _TURN_HZ, points_per_s, self.range_m)


def drive(places: Sequence[SensorPlace], lidar: Lidar, caster: Caster, standing: Mesh) -> Iterator[Scan]:
    """Give the scan of each place, with the semantic tag of each point; a scan counts as one."""
    fired = fire(lidar.fan, 0.0, 1.0 / _TURN_HZ)
    number = np.arange(fired.rays, dtype=np.int32)
    here = Transform(Vector3D(0.0, 0.0, 0.0), Rotation(0.0, 0.0, 0.0))
    ahead = aim(fired, number, here).direction * np.array([1.0, -1.0, 1.0])  # CARLA's y is on the right
    tag = standing.faces["tag"].astype(np.uint32)
    for place in places:
        hits = caster.closest(aim(fired, number, place.transform), lidar.range_m, coherent=True)
        met = np.flatnonzero(np.isfinite(hits.distance_m))
        points = ahead[met] * hits.distance_m[met, None].astype(np.float64)
        yield Scan(place.map_from_sensor, Cloud(points, tag[hits.triangle[met]]), 1)
