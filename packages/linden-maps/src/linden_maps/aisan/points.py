"""Rows of point.csv: places in the map's frame, with latitude and longitude in packed degrees, minutes and seconds."""

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden_maps.aisan.tables import Tables
from linden_maps.lanelet2.model import LaneletMap
from linden_maps.lanelet2.projection import Projection


class Points:
    """Adds points; one for each requested node of the Lanelet2 map. Their rows are written at the end."""

    def __init__(self, tables: Tables, projection: Projection) -> None:
        self._tables, self._projection = tables, projection
        self._places: list[tuple[float, float, float]] = []
        self._of_node: dict[int, int] = {}

    def new(self, place: F64) -> int:
        """Add a point and return its id."""
        x_m, y_m, z_m = place.tolist()
        self._places.append((x_m, y_m, z_m))
        return len(self._places)

    def of_node(self, source: LaneletMap, node: int) -> int:
        """Return the point of a node."""
        if node not in self._of_node:
            self._of_node[node] = self.new(np.array(source.nodes[node][:3]))
        return self._of_node[node]

    def write(self) -> None:
        """Add the rows of all points to the tables."""
        places = np.array(self._places).reshape(-1, 3)
        latitude, longitude = self._projection.degrees(places[:, 0], places[:, 1])
        columns = (packed(latitude).tolist(), packed(longitude).tolist(), *(places + 0.0).T.tolist())
        self._tables.extend(
            "point",
            (
                f"{number},{b:.10f},{ll:.10f},{z:.3f},{y:.3f},{x:.3f},0,0,0,0"
                for number, (b, ll, x, y, z) in enumerate(zip(*columns, strict=True), start=1)
            ),
        )


def packed(degrees: F64) -> F64:
    """Return degrees as D + M/100 + S/10000, with one sign for the whole."""
    size = np.round(np.abs(degrees) * 3600e6) / 1e6  # seconds; rounded first, so that 60 of them never stand
    whole, minutes, seconds = size // 3600.0, size % 3600.0 // 60.0, size % 60.0
    result: F64 = np.sign(degrees) * (whole + minutes / 100.0 + seconds / 10000.0)
    return result
