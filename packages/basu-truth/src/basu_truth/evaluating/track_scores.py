"""Scores of tracks by motmetrics: MOTA, MOTP and IDF1, with the identities of each class apart.

Rectangles match from an IoU of 0.5 on, boxes in space within 2 m in the ground plane.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import motmetrics
import numpy as np
from numpy.typing import NDArray

from basu_truth.evaluating.box_scores import ERRORS_AT_M, plane_distance_m
from basu_truth.evaluating.detections import RectangleDetection

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from basu_truth.evaluating.detections import BoxDetection
    from basu_truth.evaluating.slices import Slice
    from basu_truth.truth import Rectangle, SeenObject

LEAST_IOU = 0.5
F64 = NDArray[np.float64]


class TrackScore(NamedTuple):
    """Scores of tracks; None where the slice has no object."""

    mota: float | None
    motp: float | None  # mean IoU of rectangles that match, or mean distance of boxes in m
    idf1: float | None
    switches: int


def track_score(
    objects: Sequence[SeenObject],
    detections: Sequence[RectangleDetection] | Sequence[BoxDetection],
    part: Slice,
    counts: Callable[[SeenObject], bool],
) -> TrackScore:
    """Return the scores of tracks in a slice.

    Detections that match only objects that do not count are left out.

    Args:
        objects: one for each object and frame; for rectangles those of the camera.
        detections: with tracks.
        part: the slice; those by distance and share cut tracks into pieces, and each piece counts.
        counts: whether an object is large enough to count at all.
    """
    accumulator = motmetrics.MOTAccumulator(auto_id=True)
    frames = sorted({each.frame for each in (*objects, *detections)})
    names_of_tracks = sorted({(each.category, str(each.track)) for each in detections})
    number_of = {name: number for number, name in enumerate(names_of_tracks)}
    total = 0
    for frame in frames:
        if part.frames is not None and frame not in part.frames:
            continue
        seen = [each for each in objects if each.frame == frame and each.category in part.categories]
        found = [each for each in detections if each.frame == frame and each.category in part.categories]
        is_counted = np.array([counts(each) and part.counts(each) for each in seen], bool)
        distances = _distances(seen, found)
        near_counted = np.isfinite(distances[is_counted]).any(axis=0)
        near_others = np.isfinite(distances[~is_counted]).any(axis=0)
        kept = np.flatnonzero(near_counted | ~near_others)
        total += int(is_counted.sum())
        accumulator.update(
            [each.track for each, is_in in zip(seen, is_counted, strict=True) if is_in],
            [number_of[found[index].category, str(found[index].track)] for index in kept.tolist()],
            distances[is_counted][:, kept],
        )
    if not total:
        return TrackScore(None, None, None, 0)
    names = ["mota", "motp", "idf1", "num_switches"]
    row = motmetrics.metrics.create().compute(accumulator, metrics=names, name="all").loc["all"]
    is_plane = bool(detections) and isinstance(detections[0], RectangleDetection)
    motp = float(row["motp"])
    precision = None if np.isnan(motp) else 1.0 - motp if is_plane else motp
    return TrackScore(float(row["mota"]), precision, float(row["idf1"]), int(row["num_switches"]))


def _distances(objects: Sequence[SeenObject], detections: Sequence[RectangleDetection | BoxDetection]) -> F64:
    """Return the distances (O, D) of objects and detections; NaN where they cannot match."""
    distances = np.full((len(objects), len(detections)), np.nan)
    for row, seen in enumerate(objects):
        for column, found in enumerate(detections):
            if seen.category != found.category:
                continue
            if isinstance(found, RectangleDetection):
                assert seen.rectangle is not None, "a camera saw it"
                overlap = iou(seen.rectangle, found.rectangle)
                distances[row, column] = 1.0 - overlap if overlap >= LEAST_IOU else np.nan
            else:
                away_m = plane_distance_m(seen, found)
                distances[row, column] = away_m if away_m < ERRORS_AT_M else np.nan
    return distances


def iou(first: Rectangle, second: Rectangle) -> float:
    """Return the area that two rectangles share, as a part of the area that they cover."""
    width = min(first.left + first.width, second.left + second.width) - max(first.left, second.left)
    height = min(first.top + first.height, second.top + second.height) - max(first.top, second.top)
    shared = max(0.0, width) * max(0.0, height)
    return shared / (first.width * first.height + second.width * second.height - shared)
