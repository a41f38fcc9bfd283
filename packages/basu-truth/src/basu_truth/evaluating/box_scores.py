"""Average precision of boxes in space by the distance of their middles: the definition of nuScenes' detection task.

Source: the nuScenes detection task, and ``accumulate`` of nuscenes-devkit. Detections are matched in the order of their
scores, each to the nearest free object of its class in the ground plane. AP is the area under precision over
recall above 0.1 of both. A detection that matches an object outside of the slice is not counted.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from basu_truth.evaluating.detections import BoxDetection
    from basu_truth.evaluating.slices import Slice
    from basu_truth.truth import SeenObject

THRESHOLDS_M = (0.5, 1.0, 2.0, 4.0)
ERRORS_AT_M = 2.0  # the threshold at which translation, scale and orientation errors are measured
RECALLS = np.linspace(0.0, 1.0, 101)
LEAST_RECALL, LEAST_PRECISION = 0.1, 0.1


class BoxScore(NamedTuple):
    """Average precision and mean errors of matched detections; None where the slice has no object or no match."""

    ap: float | None  # mean over the classes and the thresholds
    translation_m: float | None
    scale: float | None  # 1 - IoU of the boxes, laid on each other
    orientation_rad: float | None
    objects: int


class _Match(NamedTuple):
    """A detection that counts: whether it is right, and the object that it is."""

    detection: BoxDetection
    object: SeenObject | None


def box_score(
    objects: Sequence[SeenObject],
    detections: Sequence[BoxDetection],
    part: Slice,
    counts: Callable[[SeenObject], bool],
) -> BoxScore:
    """Return the scores in a slice.

    Args:
        objects: one for each object and frame.
        detections: of all frames.
        part: the slice.
        counts: whether an object is large enough to count at all.
    """
    precisions: list[float] = []
    right: list[_Match] = []
    counted = 0
    for category in part.categories:
        chosen = [each for each in objects if each.category == category and _looked(each.frame, part)]
        positives = sum(counts(each) and part.counts(each) for each in chosen)
        if not positives:
            continue
        counted += positives
        found = [each for each in detections if each.category == category and _looked(each.frame, part)]
        for threshold_m in THRESHOLDS_M:
            matches = _matches(chosen, found, threshold_m, lambda each: counts(each) and part.counts(each))
            precisions.append(_average_precision(matches, positives))
            if threshold_m == ERRORS_AT_M:
                right += [match for match in matches if match.object is not None]
    if not counted:
        return BoxScore(None, None, None, None, 0)
    errors = [_errors(match) for match in right]
    if not errors:
        return BoxScore(float(np.mean(precisions)), None, None, None, counted)
    translation_m, scale, orientation_rad = np.mean(errors, axis=0).tolist()
    return BoxScore(float(np.mean(precisions)), translation_m, scale, orientation_rad, counted)


def _looked(frame: int, part: Slice) -> bool:
    return part.frames is None or frame in part.frames


def _matches(
    objects: Sequence[SeenObject],
    detections: Sequence[BoxDetection],
    threshold_m: float,
    counts: Callable[[SeenObject], bool],
) -> list[_Match]:
    """Return the detections that count, the surest first."""
    frames = {each.frame for each in objects} | {each.frame for each in detections}
    free: Mapping[int, list[SeenObject]] = {frame: [] for frame in frames}
    for seen in objects:
        free[seen.frame].append(seen)
    found = []
    for detection in sorted(detections, key=lambda each: -each.score):
        candidates = free[detection.frame]
        nearest = min(candidates, key=lambda each: plane_distance_m(each, detection), default=None)
        if nearest is None or plane_distance_m(nearest, detection) >= threshold_m:
            found.append(_Match(detection, None))
            continue
        candidates.remove(nearest)
        if counts(nearest):
            found.append(_Match(detection, nearest))
    return found


def _average_precision(matches: Sequence[_Match], positives: int) -> float:
    """Return the normalised area under the precision over the recall."""
    right = np.cumsum([match.object is not None for match in matches])
    if not len(right) or right[-1] == 0:
        return 0.0
    precision, recall = right / np.arange(1, len(right) + 1), right / positives
    curve = np.interp(RECALLS, recall, precision, right=0.0)[round(100 * LEAST_RECALL) + 1 :]
    area = float(np.mean(np.maximum(curve - LEAST_PRECISION, 0.0)) / (1.0 - LEAST_PRECISION))
    return round(area, 12)  # so that the area of a perfect detector is 1 and not a rounding more


def plane_distance_m(seen: SeenObject, detection: BoxDetection) -> float:
    """Return the distance of the middles in the ground plane."""
    return math.hypot(seen.box.x_m - detection.centre_m[0], seen.box.y_m - detection.centre_m[1])


def _errors(match: _Match) -> tuple[float, float, float]:
    """Return the errors of a match in place (m), scale and orientation (rad)."""
    seen, detection = match.object, match.detection
    assert seen is not None, "it is a match"
    smaller = math.prod(min(a, b) for a, b in zip(seen.size_m, detection.size_m, strict=True))
    union = math.prod(seen.size_m) + math.prod(detection.size_m) - smaller
    period = math.pi if seen.category == "barrier" else 2.0 * math.pi  # a barrier has no front
    turned = abs(math.remainder(math.radians(seen.box.yaw_deg - detection.yaw_deg), period))
    return plane_distance_m(seen, detection), 1.0 - smaller / union, turned
