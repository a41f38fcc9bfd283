"""Average precision of rectangles in pictures, by pycocotools: COCO's definition, thresholds of IoU 0.50 to 0.95.

A slice leaves objects out as COCO does with areas: a detection that matches such an object is not counted.
A detection that matches nothing is wrong in every slice of the same pictures and classes.
"""

from __future__ import annotations

import contextlib
import io
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

from basu_truth.formats.coco import CATEGORY_NUMBER, image_ids

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu_truth.evaluating.detections import RectangleDetection
    from basu_truth.evaluating.slices import Slice
    from basu_truth.truth import SeenObject, Truth

COUNTED, LEFT_OUT = 1.0, 3.0  # areas that say whether an object is in the slice
IN_SLICE = [0.0, 2.0]
MOST_A_PICTURE = 100  # detections that count, as in COCO


class RectangleScore(NamedTuple):
    """Average precision; None where the slice has no object."""

    ap: float | None  # mean over the thresholds 0.50, 0.55, … 0.95
    ap50: float | None
    ap75: float | None
    objects: int


def rectangle_score(
    truth: Truth,
    sensor: str,
    detections: Sequence[RectangleDetection],
    part: Slice,
    counts: Callable[[SeenObject], bool],
) -> RectangleScore:
    """Return the average precision in a slice.

    Args:
        truth: the truth.
        sensor: the camera that was looked at.
        detections: of that camera, and maybe of others, which are ignored.
        part: the slice.
        counts: whether an object is large enough to count at all.
    """
    ids = {
        key: number
        for key, number in image_ids(truth).items()
        if key[0] == sensor and (part.frames is None or key[1] in part.frames)
    }
    annotations: list[dict[str, Any]] = []
    for seen in truth.objects:
        if seen.rectangle is not None and (seen.sensor, seen.frame) in ids:
            is_counted = seen.category in part.categories and counts(seen) and part.counts(seen)
            annotations.append(
                _entry(len(annotations) + 1, ids[seen.sensor, seen.frame], seen.category, seen.rectangle)
                | {"area": COUNTED if is_counted else LEFT_OUT, "iscrowd": 0}
            )
    objects = sum(each["area"] == COUNTED for each in annotations)
    if not objects:
        return RectangleScore(None, None, None, 0)
    results = [
        _entry(number, ids[each.sensor, each.frame], each.category, each.rectangle)
        | {"area": COUNTED, "score": each.score}
        for number, each in enumerate((d for d in detections if (d.sensor, d.frame) in ids), start=1)
    ]
    precision = _precision(_coco(ids, annotations), _coco(ids, results), part)
    return RectangleScore(_mean(precision), _mean(precision[0]), _mean(precision[5]), objects)


def _precision(truth: Any, found: Any, part: Slice) -> Any:  # noqa: ANN401 - pycocotools has no types
    """Return the precision by threshold of IoU, by recall and by class; -1 where a class has no object."""
    with contextlib.redirect_stdout(io.StringIO()):  # it prints how long it takes
        judge = COCOeval(truth, found, "bbox")
        judge.params.catIds = [CATEGORY_NUMBER[name] for name in part.categories]
        judge.params.areaRng, judge.params.areaRngLbl = [IN_SLICE], ["slice"]
        judge.params.maxDets = [MOST_A_PICTURE]
        judge.evaluate()
        judge.accumulate()
    return judge.eval["precision"][:, :, :, 0, 0]


def _coco(ids: dict[tuple[str, int], int], annotations: list[dict[str, Any]]) -> Any:  # noqa: ANN401 - no types
    """Return the index of pycocotools over pictures and annotations."""
    index = COCO()
    index.dataset = {
        "images": [{"id": number} for number in ids.values()],
        "categories": [{"id": number, "name": name} for name, number in CATEGORY_NUMBER.items()],
        "annotations": annotations,
    }
    with contextlib.redirect_stdout(io.StringIO()):
        index.createIndex()
    return index


def _entry(number: int, image: int, category: str, rectangle: Any) -> dict[str, Any]:  # noqa: ANN401 - a Rectangle
    return {"id": number, "image_id": image, "category_id": CATEGORY_NUMBER[category], "bbox": list(rectangle)}


def _mean(precision: Any) -> float | None:  # noqa: ANN401 - an array
    """Return the mean over thresholds, recalls and classes with objects."""
    known = precision[precision > -1]
    return float(np.mean(known)) if known.size else None
