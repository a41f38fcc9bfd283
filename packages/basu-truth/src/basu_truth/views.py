"""What one sensor sees in one frame: the number of the object of each pixel or point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from basu_truth.categories import LABELS
from basu_truth.clouds import rows_of
from basu_truth.geometry import points_of_pixels, within_box
from basu_truth.masks import PARKED_FROM, numbers_of, tags_of
from basu_truth.rig import DEPTH, INSTANCES, SEMANTIC_LIDAR

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import carla

    from basu_truth.geometry import F64
    from basu_truth.rig import Declared
    from basu_truth.scene import Kind
    from basu_truth.truth import Sensor

MARGIN_M = 0.15  # around a box: bumpers and mirrors stand out of some
NEAR_M = 300.0  # things of the map farther away are not looked for in clouds
VOTES = 2000  # pixels of a thing of the map that vote for the box in which they lie


class View(NamedTuple):
    """What one sensor sees.

    Attributes:
        each: the sensor.
        pose: from its frame to the world (4, 4).
        numbers: of the object of each pixel (H, W), or of each row of the semantic lidar (N,); 0 for none.
        rows: of the semantic lidar; None for a camera.
    """

    each: Declared
    pose: F64
    numbers: NDArray[np.int64]
    rows: NDArray[Any] | None = None


class Things:
    """The things of the map that are objects of the truth, found again in pictures and clouds.

    The n-th of them has the number ``PARKED_FROM`` + n. Pictures of instances have numbers of their own for things,
    which no call explains. The depths of the first picture of a thing tell in which box its pixels lie.
    """

    def __init__(self, things: Sequence[Kind]) -> None:
        self._things = things
        self._places = np.array([each.box[:3, 3] for each in things]).reshape(-1, 3)
        self._number_of = np.zeros(2 * PARKED_FROM, np.int64)  # by the number in a picture
        self._number_of[:PARKED_FROM] = np.arange(PARKED_FROM)
        self._known = np.zeros(2 * PARKED_FROM, np.bool_)
        self._known[:PARKED_FROM] = True

    def __getitem__(self, number: int) -> Kind:
        """Return a thing by its number."""
        return self._things[number - PARKED_FROM]

    def seen_by_camera(self, each: Declared, measured: Mapping[str, Any], pose: F64) -> View:
        """Return what a camera sees; ``measured`` has the pictures of its twins by their blueprints.

        Without a picture of depths, things that are not known yet stay unknown.
        """
        picture = picture_of(measured[INSTANCES])
        numbers = numbers_of(picture)
        unknown = np.unique(numbers[~self._known[numbers]]).tolist() if DEPTH in measured else []
        for number in unknown:
            self._learn(number, numbers, tags_of(picture), picture_of(measured[DEPTH]), each.sensor, pose)
        return View(each, pose, self._number_of[numbers])

    def seen_by_lidar(self, each: Declared, measured: Mapping[str, Any], pose: F64) -> View:
        """Return what a lidar sees, as its semantic twin has measured it."""
        rows = rows_of(measured[SEMANTIC_LIDAR])
        numbers = rows["object_id"].astype(np.int64)
        unknown = np.flatnonzero((numbers == 0) & np.isin(rows["tag"], LABELS))
        if len(unknown):
            points = rows["xyz"][unknown].astype(np.float64) @ pose[:3, :3].T + pose[:3, 3]
            near = np.flatnonzero(np.linalg.norm(self._places - pose[:3, 3], axis=1) < NEAR_M)
            for index in near.tolist():
                thing = self._things[index]
                inside = within_box(points, thing.box, thing.size_m, margin_m=MARGIN_M)
                numbers[unknown[inside]] = PARKED_FROM + index
        return View(each, pose, numbers, rows)

    def _learn(
        self,
        number: int,
        numbers: NDArray[np.int64],
        tags: NDArray[np.uint8],
        depth: NDArray[np.uint8],
        sensor: Sensor,
        pose: F64,
    ) -> None:
        """Find the thing that a number of a picture belongs to; it is 0 for things that are no objects."""
        self._known[number] = True
        rows, columns = np.nonzero(numbers == number)
        if not np.isin(tags[rows[0], columns[0]], LABELS) or not self._things:
            return
        points = points_of_pixels(rows[:VOTES], columns[:VOTES], depth, sensor) @ pose[:3, :3].T + pose[:3, 3]
        away_m = np.linalg.norm(self._places - np.median(points, axis=0), axis=1)
        near = np.argsort(away_m, kind="stable")[:4].tolist()
        boxes = [self._things[index] for index in near]
        votes = [int(within_box(points, each.box, each.size_m, margin_m=MARGIN_M).sum()) for each in boxes]
        if max(votes) > 0:
            self._number_of[number] = PARKED_FROM + near[int(np.argmax(votes))]
        else:
            self._known[number] = False  # too far for the steps of the depths; it may come nearer


def picture_of(image: carla.Image) -> NDArray[np.uint8]:
    """Return the pixels of a picture (H, W, 4): blue, green, red, alpha."""
    return np.frombuffer(image.raw_data, np.uint8).reshape(image.height, image.width, 4)
