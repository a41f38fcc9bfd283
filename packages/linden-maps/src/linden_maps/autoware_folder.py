"""The folder of one town for Autoware: Lanelet2, projector, point cloud with metadata, Aisan files, and a manifest."""

import hashlib
import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from linden.errors import UserError
from linden_maps.lanelet2.bounds import STATED_ERROR_M
from linden_maps.lanelet2.model import LaneletMap
from linden_maps.lanelet2.projection import projection_of
from linden_maps.pointcloud.pcd_reading import clouds_of

LANELET2, PROJECTOR = "lanelet2_map.osm", "map_projector_info.yaml"
POINT_CLOUD, METADATA = "pointcloud_map.pcd", "pointcloud_map_metadata.yaml"
AISAN, MANIFEST = "aisan", "manifest.json"
_ROS1 = "maps"


class Layout(NamedTuple):
    """Where the files of a town lie in a folder; None for a file that the reader of the folder does not know."""

    lanelet2: str
    point_cloud: str
    aisan: str
    projector: str | None
    metadata: str | None

    def is_ours(self, name: str) -> bool:
        """Return whether the folder itself holds a file or folder of that name."""
        paths = [self.lanelet2, self.point_cloud, self.aisan, self.projector, self.metadata, MANIFEST]
        return name in {path.split("/")[0] for path in paths if path is not None}

    def refuse_other_towns(self, folder: Path) -> None:
        """Check that a folder holds no files below its own folders that this town's would take the place of.

        Raises:
            UserError: it holds another town; says which file.
        """
        known = {self.lanelet2, self.point_cloud, self.projector, self.metadata, MANIFEST}
        for path in sorted(folder.rglob("*")):
            name = path.relative_to(folder).as_posix()
            if "/" in name and path.is_file() and name not in known and not name.startswith(f"{self.aisan}/"):
                raise UserError(f"{folder} holds {name}, which is no part of this town; name a folder of its own")


UNIVERSE = Layout(LANELET2, POINT_CLOUD, AISAN, PROJECTOR, METADATA)
"""Names of map_loader's default settings."""


def ros1_layout(town: str) -> Layout:
    """Return the places below CARLA_AUTOWARE_CONTENTS that the launch files of carla-autoware read for a town.

    Source: carla-simulator/carla-autoware, carla_autoware_agent's launch files; ``asian`` is its spelling.
    """
    vectors = f"{_ROS1}/vector_maps"
    return Layout(
        f"{vectors}/lanelet2/{town}.osm", f"{_ROS1}/point_cloud_maps/{town}.pcd", f"{vectors}/asian/{town}", None, None
    )


_CELL_M = 20.0
"""Corners of the cloud's one cell lie at multiples of this, as Autoware's own divider puts them."""


def point_cloud_metadata(cloud: Path) -> bytes:
    """Return pointcloud_map_metadata.yaml for a cloud in one file: its cell's lower corner and its size.

    Raises:
        UserError: the cloud cannot be read, or has no points.
    """
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for part in clouds_of(cloud):
        if len(part.points_m):
            low = np.minimum(low, part.points_m[:, :2].min(axis=0))
            high = np.maximum(high, part.points_m[:, :2].max(axis=0))
    if not np.isfinite(low).all():
        raise UserError(f"{cloud} has no points; name another cloud")
    corner = [_CELL_M * math.floor(value / _CELL_M) for value in low.tolist()]
    size = [_CELL_M * math.ceil((top - least) / _CELL_M) for top, least in zip(high.tolist(), corner, strict=True)]
    return (
        f"x_resolution: {size[0]:.1f}\ny_resolution: {size[1]:.1f}\n{POINT_CLOUD}: [{corner[0]:.1f}, {corner[1]:.1f}]\n"
    ).encode()


def manifest(stage: Path, source: bytes, lanelet_map: LaneletMap) -> bytes:
    """Return manifest.json: the source, the frame and its origin, and size and hash of every file of the folder."""
    projection = projection_of(lanelet_map.geo_reference)
    origin: dict[str, Any] | None = None
    if projection is not None:
        latitude, longitude = projection.degrees(0.0, 0.0)
        origin = {"latitude_deg": round(latitude, 9), "longitude_deg": round(longitude, 9)}
    files = sorted(path for path in stage.rglob("*") if path.is_file() and path.name != MANIFEST)
    return (
        json.dumps(
            {
                "map": lanelet_map.name,
                "source": {"format": "OpenDRIVE", "sha256": hashlib.sha256(source).hexdigest()},
                "frame": "x east, y north, z up, m; x and y as in the OpenDRIVE file, z its elevation",
                "geo_reference": lanelet_map.geo_reference.strip(),
                "origin": origin,
                "bounds_within_m": STATED_ERROR_M,
                "files": {
                    path.relative_to(stage).as_posix(): {"bytes": path.stat().st_size, "sha256": _sha256(path)}
                    for path in files
                },
            },
            indent=2,
        )
        + "\n"
    ).encode()


def _sha256(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as stream:
        while block := stream.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()
