"""`evaluate`: all scores of a detector, by slices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu_truth.evaluating.rectangle_scores import rectangle_score
from basu_truth.evaluating.slices import slices

if TYPE_CHECKING:
    from collections.abc import Callable

    from basu_truth.evaluating.detections import Detections
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
    least: int
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
        sensor: the sensor that the detector looked at; None: the first that fits.
        least: visible pixels or points from which an object counts; None: 20 pixels or 1 point.

    Raises:
        UserError: there is no such sensor.
    """
    assert detections.rectangles is not None, "COCO's results are rectangles"
    cameras = [each.id for each in truth.sensors if each.is_camera]
    looked = cameras[0] if sensor is None else truth.sensor(sensor).id
    if looked not in cameras:
        raise UserError(
            f"'{looked}' is no camera, and the detections are rectangles in pictures; --sensor may be {cameras}"
        )
    least = LEAST_PIXELS if least is None else least
    counts = _large_enough(least)
    rows = []
    for part in slices(truth):
        score = rectangle_score(truth, looked, detections.rectangles, part, counts)
        rows.append(Row(part.by, part.name, score.objects, {"AP": score.ap, "AP50": score.ap50, "AP75": score.ap75}))
    return Evaluation(truth.run, detections.form, looked, least, tuple(rows))


def _large_enough(least: int) -> Callable[[SeenObject], bool]:
    return lambda seen: seen.visible >= least
