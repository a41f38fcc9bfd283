"""Detections as detectors write them: results of COCO, results of nuScenes, label files of KITTI."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu.files import read_json
from basu_truth.formats.coco import CATEGORY_NUMBER, image_ids
from basu_truth.truth import CLASSES, Rectangle

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from basu_truth.truth import Truth


class RectangleDetection(NamedTuple):
    """An object that a detector found in a picture."""

    sensor: str
    frame: int
    category: str
    rectangle: Rectangle
    score: float
    track: str | None = None


class BoxDetection(NamedTuple):
    """An object that a detector found in space; CARLA's world frame."""

    frame: int
    category: str
    centre_m: tuple[float, float, float]
    size_m: tuple[float, float, float]  # length, width, height
    yaw_deg: float
    score: float
    track: str | None = None


class Detections(NamedTuple):
    """A detector's output; None for what its format does not have."""

    form: str
    rectangles: tuple[RectangleDetection, ...] | None
    boxes: tuple[BoxDetection, ...] | None


def read_detections(path: Path, truth: Truth) -> Detections:
    """Read a detector's output.

    Raises:
        UserError: it is in none of the known forms, has frames or classes that the truth does not have, or numbers
            that are not finite.
    """
    if not path.exists():
        raise UserError(f"{path} is not there; name the file (or folder) that the detector wrote")
    document = read_json(path, "detections")
    if isinstance(document, list):
        return Detections("coco", tuple(_coco_results(document, path, truth)), None)
    raise UserError(
        f'{path} is no known form of detections; it may be a list of results as for COCO ([{{"image_id": …}}]), an '
        'object with "results" as for nuScenes, or a folder with label files of KITTI'
    )


def _coco_results(document: Sequence[Any], path: Path, truth: Truth) -> Iterable[RectangleDetection]:
    """Yield the results of COCO."""
    of_image = {number: key for key, number in image_ids(truth).items()}
    if not of_image:
        raise UserError(f"{path} has results for pictures, and the truth of {truth.run} has no camera")
    of_number = {number: name for name, number in CATEGORY_NUMBER.items()}
    for index, entry in enumerate(document, start=1):
        where = f"{path}, result {index}"
        if not isinstance(entry, dict):
            raise UserError(f"{where} is no JSON object; COCO's results have image_id, category_id, bbox and score")
        for name in ("image_id", "category_id", "bbox", "score"):
            if name not in entry:
                raise UserError(f"{where} has no {name}; COCO's results have image_id, category_id, bbox and score")
        image = of_image.get(entry["image_id"]) if isinstance(entry["image_id"], int) else None
        if image is None:
            raise UserError(
                f"{where} is for image_id {entry['image_id']!r}, which the truth does not have; it has 1 to "
                f"{len(of_image)}: see annotations.json of the export"
            )
        category = of_number.get(entry["category_id"]) if isinstance(entry["category_id"], int) else None
        if category is None:
            names = ", ".join(f"{number} ({name})" for number, name in of_number.items())
            raise UserError(f"{where} has category_id {entry['category_id']!r}; it may be {names}")
        left, top, width, height = finite(entry["bbox"], 4, where, "bbox")
        (score,) = finite([entry["score"]], 1, where, "score")
        if width <= 0.0 or height <= 0.0:
            raise UserError(f"{where} has a bbox without an area, {entry['bbox']}; it is [left, top, width, height]")
        track = entry.get("track_id")
        yield RectangleDetection(
            *image, category, Rectangle(left, top, width, height), score, None if track is None else str(track)
        )


def finite(values: Any, count: int, where: str, name: str) -> list[float]:  # noqa: ANN401 - as given
    """Return numbers as they stand in a document.

    Raises:
        UserError: they are not so many, or not finite.
    """
    if not isinstance(values, list) or len(values) != count:
        raise UserError(f"{where} has {name} {values!r}; it must be {count} numbers")
    for value in values:
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise UserError(f"{where} has {name} {values!r}; each number must be finite, neither NaN nor infinite")
    return [float(value) for value in values]


def known_class(name: object, where: str) -> str:
    """Return the name of a class.

    Raises:
        UserError: there is none of that name.
    """
    if name not in CLASSES:
        raise UserError(f"{where} has the class {name!r}; there are {', '.join(CLASSES)}")
    return str(name)
