"""The drive: a map's standing scene measured by the server's own lidar, place after place.

In the same process, not through a client: it takes the lidar's rays and the caster as a server's sensor does, but no
time passes between two places, so that nothing moves and nothing is smeared, and no clouds go over a socket.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from linden.casting.rays import Caster
from linden.meshes.mesh import Mesh
from linden.pointcloud.cloud import Cloud, Scan
from linden.pointcloud.streets import Place
from linden.sensors.lidar.fan import Fan, aim, fire
from linden.values.space import Rotation, Transform, Vector3D

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


def drive(places: Sequence[Place], lidar: Lidar, caster: Caster, standing: Mesh) -> Iterator[Scan]:
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
