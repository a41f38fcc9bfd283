"""COCO's format for detection: ``annotations.json`` and a folder of pictures for each camera.

Source: https://cocodataset.org/#format-data. Beside the fields of COCO each annotation has ``track_id``, ``sensor``,
``visibility``, ``distance_m``, ``whole_bbox`` and ``cuboid``, which COCO's own programs ignore.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from basu.files import write_bytes
from basu_truth.pictures import write_picture
from basu_truth.truth import CLASSES

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from basu_truth.scene import Shot
    from basu_truth.truth import SeenObject, Sensor, Truth

ANNOTATIONS_FILE, PICTURES = "annotations.json", "images"
CATEGORY_NUMBER = {name: number for number, name in enumerate(CLASSES, start=1)}


class CocoWriter:
    """Writes the cameras of an export."""

    def __init__(self, folder: Path, sensors: Sequence[Sensor]) -> None:
        self._folder, self._cameras = folder, [each for each in sensors if each.is_camera]

    def write(self, shot: Shot, objects: Sequence[SeenObject]) -> None:  # noqa: ARG002 - the truth has the objects
        """Write the pictures of a frame."""
        for camera in self._cameras:
            path = self._folder / file_name(camera.id, shot.number)
            write_picture(path, shot.measured[camera.id][camera.type_id])

    def finish(self, truth: Truth) -> None:
        """Write the file of annotations of COCO."""
        document = coco_document(truth)
        write_bytes(self._folder / ANNOTATIONS_FILE, (json.dumps(document, separators=(",", ":")) + "\n").encode())


def file_name(sensor_id: str, frame: int) -> str:
    """Return the place of a picture in the export."""
    return f"{PICTURES}/{sensor_id}/{frame:06d}.png"


def image_ids(truth: Truth) -> dict[tuple[str, int], int]:
    """Return the id of each picture, from 1, by sensor and frame: camera after camera, frame after frame."""
    cameras = [each.id for each in truth.sensors if each.is_camera]
    keys = [(camera, frame.number) for camera in cameras for frame in truth.frames]
    return {key: number for number, key in enumerate(keys, start=1)}


def coco_document(truth: Truth) -> dict[str, Any]:
    """Return the document of COCO."""
    ids = image_ids(truth)
    time_s = {frame.number: frame.t_s for frame in truth.frames}
    sizes = {each.id: (each.width_px, each.height_px) for each in truth.sensors}
    images = [
        {
            "id": number,
            "file_name": file_name(camera, frame),
            "width": sizes[camera][0],
            "height": sizes[camera][1],
            "sensor": camera,
            "frame": frame,
            "t_s": time_s[frame],
        }
        for (camera, frame), number in ids.items()
    ]
    seen = [each for each in truth.objects if each.rectangle is not None]
    return {
        "info": {"description": f"ground truth of {truth.run}", "version": "1"},
        "images": images,
        "categories": [{"id": number, "name": name} for name, number in CATEGORY_NUMBER.items()],
        "annotations": [
            _annotation(number, each, ids[each.sensor, each.frame]) for number, each in enumerate(seen, start=1)
        ],
    }


def _annotation(number: int, seen: SeenObject, image_id: int) -> dict[str, Any]:
    """Return one object; its rectangle is that of the visible pixels, and its area their number."""
    assert seen.rectangle is not None, "a camera saw it"
    return {
        "id": number,
        "image_id": image_id,
        "category_id": CATEGORY_NUMBER[seen.category],
        "bbox": list(seen.rectangle),
        "area": seen.visible,
        "iscrowd": 0,
        "track_id": seen.track,
        "visibility": None if seen.visibility is None else round(seen.visibility, 6),
        "distance_m": round(seen.distance_m, 3),
        "whole_bbox": None if seen.whole_rectangle is None else list(seen.whole_rectangle),
        "cuboid": {
            "pose_in_camera": [round(value, 4) for value in seen.box_in_sensor],
            "size_m": [round(value, 4) for value in seen.size_m],
        },
    }
