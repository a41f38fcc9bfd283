"""Detections made of the truth: a perfect detector's, or those of one that is wrong by a known amount."""

import json
from pathlib import Path
from typing import Any

from basu_truth.formats.coco import CATEGORY_NUMBER, image_ids
from basu_truth.truth import Truth


def coco_results(truth: Truth, *, shift: float = 0.0, tracks: bool = False) -> list[dict[str, Any]]:
    """Return results of COCO with rectangles moved to the right by a share of their width."""
    ids = image_ids(truth)
    return [
        {
            "image_id": ids[each.sensor, each.frame],
            "category_id": CATEGORY_NUMBER[each.category],
            "bbox": [
                each.rectangle.left + shift * each.rectangle.width,
                each.rectangle.top,
                each.rectangle.width,
                each.rectangle.height,
            ],
            "score": 0.9,
            **({"track_id": each.track} if tracks else {}),
        }
        for each in truth.objects
        if each.rectangle is not None
    ]


def written(path: Path, document: Any) -> Path:
    """Write a document of JSON and return its place; NaN is written as Python writes it."""
    path.write_text(json.dumps(document), "utf-8")
    return path
