"""`evaluate`: all scores of a detector, by slices."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu_truth.evaluating.box_scores import box_score
from basu_truth.evaluating.rectangle_scores import rectangle_score
from basu_truth.evaluating.slices import slices
from basu_truth.evaluating.track_scores import has_hota, track_score
from basu_truth.formats.kitti import TYPE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu_truth.evaluating.detections import BoxDetection, Detections, RectangleDetection
    from basu_truth.evaluating.slices import Slice
    from basu_truth.truth import SeenObject, Truth

LEAST_PIXELS, LEAST_POINTS = 20, 1


class Row(NamedTuple):
    """The scores of one slice."""

    by: str
    name: str
    objects: int
    scores: dict[str, float | None]


class Evaluation(NamedTuple):
    """The scores of a detector."""

    run: str
    form: str
    sensor: str
    least: int | None
    rows: tuple[Row, ...]

    def document(self) -> dict[str, Any]:
        """Return the evaluation as a document of JSON."""
        return {**self._asdict(), "rows": [row._asdict() for row in self.rows]}


def evaluate(
    truth: Truth, detections: Detections, *, sensor: str | None = None, least: int | None = None
) -> Evaluation:
    """Score a detector's output against the truth.

    Args:
        truth: the truth.
        detections: the output.
        sensor: the sensor that the detector looked at. None: the first camera for rectangles, and for boxes in space
            all sensors together.
        least: visible pixels or points from which an object counts; None: 20 pixels, 1 point.

    Raises:
        UserError: there is no such sensor, or it is no camera and the detections are rectangles.
    """
    counts = _large_enough(truth, least)
    looked = None if sensor is None else truth.sensor(sensor)
    if detections.form == "kitti":
        truth = with_types_of_kitti(truth)
    rows: list[Row] = []
    if detections.rectangles is not None:
        camera = looked or next(each for each in truth.sensors if each.is_camera)
        if not camera.is_camera:
            raise UserError(
                f"'{camera.id}' is no camera, and the detections are rectangles in pictures; --sensor may be "
                f"{', '.join(each.id for each in truth.sensors if each.is_camera)}"
            )
        rows = _rectangle_rows(truth, camera.id, detections.rectangles, counts)
    if detections.boxes is not None:
        one = sensor if detections.rectangles is None else camera.id
        of_boxes = _box_rows(truth, one, detections.boxes, counts)
        rows = [_joined(*pair) for pair in zip(rows, of_boxes, strict=True)] if rows else of_boxes
    name = sensor or (camera.id if detections.rectangles is not None else "all sensors")
    return Evaluation(truth.run, detections.form, name, least, tuple(rows))


def with_types_of_kitti(truth: Truth) -> Truth:
    """Return a truth without the objects that KITTI has no type for."""
    return replace(truth, objects=tuple(each for each in truth.objects if each.category in TYPE))


def one_a_frame(objects: Sequence[SeenObject], sensor: str | None) -> list[SeenObject]:
    """Return each object once a frame: as one sensor saw it, or as the sensor did that saw the largest share of it."""
    best: dict[tuple[int, int], SeenObject] = {}
    for each in objects:
        key = each.frame, each.track
        if (sensor is None or each.sensor == sensor) and (key not in best or _rank(each) > _rank(best[key])):
            best[key] = each
    return [best[key] for key in sorted(best)]


def _rectangle_rows(
    truth: Truth, camera: str, found: Sequence[RectangleDetection], counts: Callable[[SeenObject], bool]
) -> list[Row]:
    """Return the scores of rectangles in pictures."""
    rows = []
    objects = [each for each in truth.objects if each.sensor == camera]
    mine = [each for each in found if each.sensor == camera]
    for part in slices(truth):
        score = rectangle_score(truth, camera, mine, part, counts)
        scores = {"AP": score.ap, "AP50": score.ap50, "AP75": score.ap75}
        rows.append(Row(part.by, part.name, score.objects, scores | _track_scores(objects, mine, part, counts)))
    return rows


def _box_rows(
    truth: Truth, sensor: str | None, found: Sequence[BoxDetection], counts: Callable[[SeenObject], bool]
) -> list[Row]:
    """Return the scores of boxes in space."""
    objects, rows = one_a_frame(truth.objects, sensor), []
    for part in slices(truth):
        score = box_score(objects, found, part, counts)
        scores = {
            "AP 3D": score.ap,
            "ATE m": score.translation_m,
            "ASE": score.scale,
            "AOE rad": score.orientation_rad,
        }
        rows.append(Row(part.by, part.name, score.objects, scores | _track_scores(objects, found, part, counts)))
    return rows


def _track_scores(
    objects: Sequence[SeenObject],
    found: Sequence[RectangleDetection] | Sequence[BoxDetection],
    part: Slice,
    counts: Callable[[SeenObject], bool],
) -> dict[str, float | None]:
    """Return the scores of tracks; an empty dict without detections, or if one has no track."""
    if not found or any(each.track is None for each in found):
        return {}
    score = track_score(objects, found, part, counts)
    scores = {"MOTA": score.mota, "MOTP": score.motp, "IDF1": score.idf1}
    if not has_hota():
        return scores
    hota, detections, association = (None, None, None) if score.hota is None else score.hota
    return scores | {"HOTA": hota, "DetA": detections, "AssA": association}


def _joined(first: Row, second: Row) -> Row:
    """Return the scores of rectangles and of boxes of the same slice; the number of objects is that of the camera."""
    return first._replace(scores=first.scores | second.scores)


def _rank(seen: SeenObject) -> tuple[float, int]:
    return (-1.0 if seen.visibility is None else seen.visibility, seen.visible)


def _large_enough(truth: Truth, least: int | None) -> Callable[[SeenObject], bool]:
    """Return whether an object has enough pixels or points to count."""
    cameras = {each.id for each in truth.sensors if each.is_camera}
    pixels, points = (LEAST_PIXELS, LEAST_POINTS) if least is None else (least, least)
    return lambda seen: seen.visible >= (pixels if seen.sensor in cameras else points)
