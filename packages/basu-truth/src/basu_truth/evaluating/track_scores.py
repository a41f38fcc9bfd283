"""Scores of tracks, with the identities of each class apart: MOTA, MOTP and IDF1 by motmetrics, HOTA by trackers.

Rectangles match from an IoU of 0.5 on, boxes in space within 2 m in the ground plane. HOTA needs no such limit: it is
the mean over 19 limits of the similarity, 0.05 to 0.95 (Luiten et al. 2021, "HOTA", equations 3 to 18). The package
trackers is an extra of basu-truth; without it the scores of HOTA are left out.
"""

from __future__ import annotations

import importlib.util
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
HOTA_PACKAGE = "trackers"
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


class TrackScore(NamedTuple):
    """Scores of tracks; None where the slice has no object."""

    mota: float | None
    motp: float | None  # mean IoU of rectangles that match, or mean distance of boxes in m
    idf1: float | None
    switches: int
    hota: HotaScore | None  # None also without the package trackers


class HotaScore(NamedTuple):
    """HOTA and its two factors: the accuracy of the detections, and that of their association to tracks."""

    hota: float
    detections: float
    association: float


class _TrackFrames:
    """What HOTA needs of each frame: the identities of objects and detections, and the similarity of each pair."""

    def __init__(self) -> None:
        self.objects: list[I64] = []
        self.detections: list[I64] = []
        self.similarities: list[F64] = []

    def add(self, objects: Sequence[int], detections: Sequence[int], similarities: F64) -> None:
        """Add a frame; the similarities (O, D) are 0 to 1."""
        self.objects.append(np.array(objects, np.int64))
        self.detections.append(np.array(detections, np.int64))
        self.similarities.append(similarities)

    def score(self) -> HotaScore | None:
        """Return HOTA; None without the package trackers."""
        if not has_hota():
            return None
        from trackers.eval.hota import compute_hota_metrics  # noqa: PLC0415 - an extra, and it loads OpenCV

        found = compute_hota_metrics(self.objects, self.detections, self.similarities)
        return HotaScore(float(found["HOTA"]), float(found["DetA"]), float(found["AssA"]))


def has_hota() -> bool:
    """Return whether the package that computes HOTA is installed."""
    return importlib.util.find_spec(HOTA_PACKAGE) is not None


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
    is_plane = bool(detections) and isinstance(detections[0], RectangleDetection)
    accumulator = motmetrics.MOTAccumulator(auto_id=True)
    frames = sorted({each.frame for each in (*objects, *detections)})
    names_of_tracks = sorted({(each.category, str(each.track)) for each in detections})
    number_of = {name: number for number, name in enumerate(names_of_tracks)}
    total, track_frames = 0, _TrackFrames()
    for frame in frames:
        if part.frames is not None and frame not in part.frames:
            continue
        seen = [each for each in objects if each.frame == frame and each.category in part.categories]
        found = [each for each in detections if each.frame == frame and each.category in part.categories]
        is_counted = np.array([counts(each) and part.counts(each) for each in seen], bool)
        similarities = _similarities(seen, found)
        distances = _distances(similarities, are_rectangles=is_plane)
        near_counted = np.isfinite(distances[is_counted]).any(axis=0)
        near_others = np.isfinite(distances[~is_counted]).any(axis=0)
        kept = np.flatnonzero(near_counted | ~near_others)
        total += int(is_counted.sum())
        tracks = [each.track for each, is_in in zip(seen, is_counted, strict=True) if is_in]
        found_tracks = [number_of[found[index].category, str(found[index].track)] for index in kept.tolist()]
        accumulator.update(tracks, found_tracks, distances[is_counted][:, kept])
        track_frames.add(tracks, found_tracks, similarities[is_counted][:, kept])
    if not total:
        return TrackScore(None, None, None, 0, None)
    names = ["mota", "motp", "idf1", "num_switches"]
    row = motmetrics.metrics.create().compute(accumulator, metrics=names, name="all").loc["all"]
    motp = float(row["motp"])
    precision = None if np.isnan(motp) else 1.0 - motp if is_plane else motp
    mota, idf1, switches = float(row["mota"]), float(row["idf1"]), int(row["num_switches"])
    return TrackScore(mota, precision, idf1, switches, track_frames.score())


def _distances(similarities: F64, *, are_rectangles: bool) -> F64:
    """Return the distances (O, D) of motmetrics: 1 less the IoU, or m; NaN where object and detection cannot match."""
    if are_rectangles:
        return np.where(similarities >= LEAST_IOU, 1.0 - similarities, np.nan)
    return np.where(similarities > 0.0, ERRORS_AT_M * (1.0 - similarities), np.nan)


def _similarities(objects: Sequence[SeenObject], detections: Sequence[RectangleDetection | BoxDetection]) -> F64:
    """Return the similarities (O, D): the IoU, or for boxes 1 at the object's middle, falling to 0 at 2 m from it."""
    similarities = np.zeros((len(objects), len(detections)))
    for row, seen in enumerate(objects):
        for column, found in enumerate(detections):
            if seen.category != found.category:
                continue
            if isinstance(found, RectangleDetection):
                assert seen.rectangle is not None, "a camera saw it"
                similarities[row, column] = iou(seen.rectangle, found.rectangle)
            else:
                similarities[row, column] = max(0.0, 1.0 - plane_distance_m(seen, found) / ERRORS_AT_M)
    return similarities


def iou(first: Rectangle, second: Rectangle) -> float:
    """Return the area that two rectangles share, as a part of the area that they cover."""
    width = min(first.left + first.width, second.left + second.width) - max(first.left, second.left)
    height = min(first.top + first.height, second.top + second.height) - max(first.top, second.top)
    shared = max(0.0, width) * max(0.0, height)
    return shared / (first.width * first.height + second.width * second.height - shared)
