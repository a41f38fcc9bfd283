"""Detections made of the truth: a perfect detector's, or those of one that is wrong by a known amount."""

import json
from pathlib import Path
from typing import Any

from basu_truth.evaluating.scoring import one_a_frame
from basu_truth.formats.coco import CATEGORY_NUMBER, image_ids
from basu_truth.formats.kitti import label
from basu_truth.formats.nuscenes import sample_tokens
from basu_truth.right_handed import quaternion, right_handed, translation
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


def nuscenes_results(
    truth: Truth, *, shift_m: float = 0.0, larger: float = 1.0, turn_deg: float = 0.0
) -> dict[str, Any]:
    """Return results of nuScenes' tracking task with boxes that are moved east, made larger and turned clockwise."""
    frames = {number: sample for sample, number in sample_tokens(truth).items()}
    results: dict[str, Any] = {sample: [] for sample in frames.values()}
    for each in one_a_frame(truth.objects, None):
        turned = each.box._replace(yaw_deg=each.box.yaw_deg + turn_deg, x_m=each.box.x_m + shift_m)
        length, width, height = (larger * size for size in each.size_m)
        box = right_handed(turned)
        sample = frames[each.frame]
        results[sample].append(
            {
                "sample_token": sample,
                "translation": translation(box),
                "size": [width, length, height],
                "rotation": quaternion(box),
                "velocity": [each.velocity_mps[0], -each.velocity_mps[1]],
                "tracking_id": str(each.track),
                "tracking_name": each.category,
                "tracking_score": 0.9,
            }
        )
    return {"meta": {"use_camera": True}, "results": results}


def kitti_results(folder: Path, truth: Truth) -> Path:
    """Write label files with scores into a new folder: those of a perfect detector."""
    folder.mkdir()
    camera = next(each.id for each in truth.sensors if each.is_camera)
    for frame in truth.frames:
        seen = [each for each in truth.objects if (each.frame, each.sensor) == (frame.number, camera)]
        (folder / f"{frame.number:06d}.txt").write_text("".join(f"{label(each)} 0.9\n" for each in seen))
    return folder


def written(path: Path, document: Any) -> Path:
    """Write a document of JSON and return its place; NaN is written as Python writes it."""
    path.write_text(json.dumps(document), "utf-8")
    return path
