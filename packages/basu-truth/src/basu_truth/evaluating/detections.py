"""Detections as detectors write them: results of COCO, results of nuScenes, label files of KITTI."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.errors import UserError
from basu.files import read_json
from basu_truth.formats.coco import CATEGORY_NUMBER, image_ids
from basu_truth.formats.kitti import OTHER_TYPE, TYPE
from basu_truth.formats.nuscenes import sample_tokens
from basu_truth.geometry import matrix
from basu_truth.right_handed import yaw_deg_of
from basu_truth.truth import CLASSES, Rectangle

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from basu_truth.truth import Truth


IGNORED_TYPES = ("DontCare", "Tram", "Person_sitting", OTHER_TYPE)
"""Types of KITTI that stand for no class of ours."""
KITTI_NUMBERS = 15  # after the type: truncation, occlusion, alpha, rectangle, sizes, place, rotation, score


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
    if path.is_dir():
        return _kitti_results(path, truth)
    document = read_json(path, "detections")
    if isinstance(document, list):
        return Detections("coco", tuple(_coco_results(document, path, truth)), None)
    if isinstance(document, dict) and isinstance(document.get("results"), dict):
        return Detections("nuscenes", None, tuple(_nuscenes_results(document["results"], path, truth)))
    raise UserError(
        f'{path} is no known form of detections; it may be a list of results as for COCO ([{{"image_id": …}}]), an '
        'object with "results" as for nuScenes, or a folder with label files of KITTI'
    )


def _coco_results(document: Sequence[Any], path: Path, truth: Truth) -> Iterable[RectangleDetection]:
    """Yield the detections of a file of COCO results."""
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


def _nuscenes_results(results: Mapping[str, Any], path: Path, truth: Truth) -> Iterable[BoxDetection]:
    """Yield the results of nuScenes, of its detection task or of its tracking task."""
    frame_of = sample_tokens(truth)
    for sample, entries in results.items():
        if sample not in frame_of:
            raise UserError(
                f"{path} has results for the sample {sample}, which the truth of {truth.run} does not have; see "
                "sample.json of the export"
            )
        for index, entry in enumerate(entries if isinstance(entries, list) else [None], start=1):
            where = f"{path}, sample {sample}, result {index}"
            if not isinstance(entry, dict):
                raise UserError(f"{where} is no JSON object; nuScenes' results have translation, size and rotation")
            kind = "tracking" if "tracking_name" in entry else "detection"
            x, y, z = finite(entry.get("translation"), 3, where, "translation")
            width, length, height = finite(entry.get("size"), 3, where, "size")
            rotation = finite(entry.get("rotation"), 4, where, "rotation")
            (score,) = finite([entry.get(f"{kind}_score")], 1, where, f"{kind}_score")
            if min(width, length, height) <= 0.0 or not any(rotation):
                raise UserError(f"{where} has a box without a volume or without an attitude; sizes must be above 0")
            track = entry.get("tracking_id")
            yield BoxDetection(
                frame_of[sample],
                known_class(entry.get(f"{kind}_name"), where),
                (x, -y, z),
                (length, width, height),
                yaw_deg_of(rotation),
                score,
                None if track is None else str(track),
            )


def _kitti_results(folder: Path, truth: Truth) -> Detections:
    """Return the detections of a folder with label files, one for each frame, each line with a score at its end."""
    camera = next((each for each in truth.sensors if each.is_camera), None)
    files = sorted(folder.glob("*.txt"))
    if not files or camera is None:
        raise UserError(f"{folder} has no label files of KITTI (000001.txt, …), or the truth has no camera for them")
    egos = {f"{frame.number:06d}": frame for frame in truth.frames}
    rectangles: list[RectangleDetection] = []
    boxes: list[BoxDetection] = []
    for file in files:
        frame = egos.get(file.stem)
        if frame is None:
            raise UserError(
                f"{file} is for a frame that the truth of {truth.run} does not have; it has {min(egos)} to {max(egos)}"
            )
        to_world = matrix(frame.ego) @ matrix(camera.pose)
        for number, line in enumerate(file.read_text("utf-8", errors="replace").splitlines(), start=1):
            found = _kitti_line(line.split(), f"{file}, line {number}")
            if found is None:
                continue
            category, values = found
            left, top, right, bottom, height_m, width_m, length_m, right_m, down_m, ahead_m, yaw, score = values
            place = to_world @ np.array([ahead_m, right_m, height_m / 2.0 - down_m, 1.0])
            forward = to_world[:3, :3] @ np.array([-math.sin(yaw), math.cos(yaw), 0.0])
            rectangles.append(
                RectangleDetection(
                    camera.id, frame.number, category, Rectangle(left, top, right - left, bottom - top), score
                )
            )
            heading_deg = math.degrees(math.atan2(forward[1], forward[0]))
            x, y, z = place[:3].tolist()
            boxes.append(
                BoxDetection(frame.number, category, (x, y, z), (length_m, width_m, height_m), heading_deg, score)
            )
    return Detections("kitti", tuple(rectangles), tuple(boxes))


def _kitti_line(words: list[str], where: str) -> tuple[str, list[float]] | None:
    """Return class and numbers of a line from its rectangle on; None for regions and types that do not count."""
    if not words or words[0] in IGNORED_TYPES:
        return None
    category = next((ours for ours, theirs in TYPE.items() if theirs == words[0]), None)
    if category is None:
        raise UserError(f"{where} has the type {words[0]!r}; it may be {', '.join(TYPE.values())} or DontCare")
    try:
        values = [float(word) for word in words[1:]]
    except ValueError as error:
        raise UserError(f"{where} has a word that is no number: {error}") from error
    if len(values) != KITTI_NUMBERS:
        raise UserError(f"{where} has {len(words)} words; a detection of KITTI has 16, and the last one is its score")
    finite(values, KITTI_NUMBERS, where, "its numbers")
    numbers = values[3:]
    if numbers[2] <= numbers[0] or numbers[3] <= numbers[1] or min(numbers[4:7]) <= 0.0:
        raise UserError(f"{where} has a rectangle or a box without a size; the corners are left, top, right, bottom")
    return category, numbers


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
