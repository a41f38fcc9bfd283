"""An Aisan vector map in the making: its lanes, points and rows so far."""

import math

import numpy as np

from linden.maps.opendrive.evaluate.pieces import F64
from linden_maps.aisan.lanes import courses_of, graph_of
from linden_maps.aisan.points import Points
from linden_maps.aisan.tables import Tables
from linden_maps.lanelet2.model import LaneletMap
from linden_maps.lanelet2.projection import NOWHERE, projection_of


class VectorMapDraft:
    """A vector map in the making."""

    def __init__(self, lanelet_map: LaneletMap) -> None:
        self.source = lanelet_map
        self.tables = Tables()
        self.points = Points(self.tables, projection_of(lanelet_map.geo_reference) or NOWHERE)
        self.courses = courses_of(lanelet_map)
        self.graph = graph_of(lanelet_map, self.courses)
        rows = np.array([course.rows for course in self.courses], dtype=np.int64)
        self.first_row = (np.cumsum(rows) - rows + 1).tolist()  # LnID of each course's first row
        self.course_of = {course.lanelet: nth for nth, course in enumerate(self.courses)}

    def nearest_row(self, lanelets: list[int], place: F64) -> int:
        """Return the LnID of the row among some lanelets that is nearest to a place, 0 where there are none."""
        best, row = math.inf, 0
        for lanelet in lanelets:
            nth = self.course_of.get(lanelet)
            if nth is None:
                continue
            middle = self.courses[nth].middle
            centres = (middle[:-1] + middle[1:]) / 2.0
            away = np.linalg.norm(centres - place, axis=1)
            at = int(np.argmin(away))
            if away[at] < best:
                best, row = float(away[at]), self.first_row[nth] + at
        return row
