"""nuScenes: the tables of the schema as JSON files, pictures as PNG, clouds as float32.

Source: https://www.nuscenes.org/nuscenes#data-format and the schema of nuscenes-devkit. Frames are
right-handed: x forward (world: east), y left (world: north), z up. A camera's frame is that of its picture. Timestamps
count from the first frame of the recording. The mask of the map is empty.
"""

from __future__ import annotations

import hashlib
import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from basu.files import write_bytes
from basu_truth.clouds import points_of, rings_of
from basu_truth.geometry import focal_px
from basu_truth.pictures import write_picture
from basu_truth.rig import LIDARS
from basu_truth.right_handed import FROM_CAMERA, quaternion, right_handed, translation

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from basu_truth.scene import Shot
    from basu_truth.truth import SeenObject, Sensor, Truth

VERSION, SPLIT = "v1.0-basu", "basu"
"""The names of the tables' folder and of the one split, which holds the one scene."""
MAP_FILE = "maps/basu.png"
CATEGORY = {
    "car": "vehicle.car",
    "truck": "vehicle.truck",
    "bus": "vehicle.bus.rigid",
    "motorcycle": "vehicle.motorcycle",
    "bicycle": "vehicle.bicycle",
    "pedestrian": "human.pedestrian.adult",
    "animal": "animal",
    "traffic_cone": "movable_object.trafficcone",
    "barrier": "movable_object.barrier",
}
LEVELS = ((0.4, "1", "v0-40"), (0.6, "2", "v40-60"), (0.8, "3", "v60-80"), (math.inf, "4", "v80-100"))
"""Visible shares below which a level holds, with its token and its name."""
ATTRIBUTES = (
    "vehicle.moving",
    "vehicle.stopped",
    "vehicle.parked",
    "cycle.with_rider",
    "pedestrian.moving",
    "pedestrian.standing",
)
MOVING_MPS = 0.2
MICROSECONDS = 1e6

Rows = list[dict[str, Any]]


def token(*names: object) -> str:
    """Return the same token of 32 hexadecimal digits for the same names."""
    return hashlib.sha256("/".join(map(str, names)).encode()).hexdigest()[:32]


def sample_tokens(truth: Truth) -> dict[str, int]:
    """Return the frame of each sample by its token."""
    return {token(truth.run, "sample", frame.number): frame.number for frame in truth.frames}


def channels(sensors: Sequence[Sensor]) -> dict[str, str]:
    """Return the channel of each sensor: ``CAM_`` or ``LIDAR_`` and its id; the first lidar is ``LIDAR_TOP``.

    The public devkit measures distances from ``LIDAR_TOP``.
    """
    lidars = [each.id for each in sensors if not each.is_camera]
    named = {each.id: f"CAM_{each.id}" if each.is_camera else f"LIDAR_{each.id}" for each in sensors}
    return named | ({lidars[0]: "LIDAR_TOP"} if lidars else {})


class NuscenesWriter:
    """Writes an export as nuScenes."""

    def __init__(self, folder: Path, sensors: Sequence[Sensor]) -> None:
        self._folder, self._sensors, self._channels = folder, sensors, channels(sensors)

    def write(self, shot: Shot, objects: Sequence[SeenObject]) -> None:  # noqa: ARG002 - the truth has the objects
        """Write the pictures and clouds of a frame."""
        for each in self._sensors:
            path = self._folder / _file_name(each, self._channels[each.id], shot.number)
            measured = shot.measured[each.id][each.type_id]
            if each.is_camera:
                write_picture(path, measured)
                continue
            points = points_of(measured, is_semantic=each.type_id == LIDARS[1])
            points[:, 1] *= -1.0
            path.parent.mkdir(parents=True, exist_ok=True)
            write_bytes(path, np.column_stack([points, rings_of(measured)]).astype("<f4").tobytes())

    def finish(self, truth: Truth) -> None:
        """Write the tables of nuScenes as JSON files."""
        folder = self._folder / VERSION
        folder.mkdir()
        (self._folder / "maps").mkdir()
        Image.fromarray(np.zeros((10, 10), np.uint8)).save(self._folder / MAP_FILE)
        for name, rows in {**tables(truth), "splits": {SPLIT: [truth.run]}}.items():
            write_bytes(folder / f"{name}.json", (json.dumps(rows, indent=0) + "\n").encode())


def tables(truth: Truth) -> dict[str, Rows]:
    """Return the tables of the schema by their names."""
    run, named = truth.run, channels(truth.sensors)
    samples = list(sample_tokens(truth))
    annotations, instances = _annotations(truth)
    log = token(run, "log")
    return {
        "category": [
            {"token": token("category", name), "name": name, "description": ours} for ours, name in CATEGORY.items()
        ],
        "attribute": [{"token": token("attribute", name), "name": name, "description": ""} for name in ATTRIBUTES],
        "visibility": [{"token": number, "level": level, "description": ""} for _, number, level in LEVELS],
        "instance": instances,
        "sensor": [
            {
                "token": token(run, "sensor", each.id),
                "channel": named[each.id],
                "modality": "camera" if each.is_camera else "lidar",
            }
            for each in truth.sensors
        ],
        "calibrated_sensor": [_calibrated(truth, each) for each in truth.sensors],
        "ego_pose": [
            {
                "token": token(run, "ego", frame.number),
                "timestamp": round(frame.t_s * MICROSECONDS),
                "rotation": quaternion(right_handed(frame.ego)),
                "translation": translation(right_handed(frame.ego)),
            }
            for frame in truth.frames
        ],
        "log": [{"token": log, "logfile": run, "vehicle": run, "date_captured": "", "location": truth.town}],
        "scene": [
            {
                "token": token(run, "scene"),
                "log_token": log,
                "nbr_samples": len(samples),
                "first_sample_token": samples[0],
                "last_sample_token": samples[-1],
                "name": run,
                "description": f"a run of BASU in {truth.town}",
            }
        ],
        "sample": _linked(
            [
                {
                    "token": sample,
                    "timestamp": round(frame.t_s * MICROSECONDS),
                    "scene_token": token(run, "scene"),
                }
                for sample, frame in zip(samples, truth.frames, strict=True)
            ]
        ),
        "sample_data": [row for each in truth.sensors for row in _measurements(truth, each, named[each.id])],
        "sample_annotation": annotations,
        "map": [{"token": token(run, "map"), "log_tokens": [log], "category": "semantic_prior", "filename": MAP_FILE}],
    }


def _file_name(sensor: Sensor, channel: str, frame: int) -> str:
    """Return the place of a measurement in the export."""
    return f"samples/{channel}/{frame:06d}.{'png' if sensor.is_camera else 'pcd.bin'}"


def _calibrated(truth: Truth, sensor: Sensor) -> dict[str, Any]:
    """Return pose and camera matrix of a sensor."""
    pose, intrinsic = right_handed(sensor.pose), []
    if sensor.is_camera:
        pose, focal = pose @ FROM_CAMERA, focal_px(sensor)
        intrinsic = [[focal, 0.0, sensor.width_px / 2.0], [0.0, focal, sensor.height_px / 2.0], [0.0, 0.0, 1.0]]
    return {
        "token": token(truth.run, "calibrated", sensor.id),
        "sensor_token": token(truth.run, "sensor", sensor.id),
        "translation": translation(pose),
        "rotation": quaternion(pose),
        "camera_intrinsic": intrinsic,
    }


def _measurements(truth: Truth, sensor: Sensor, channel: str) -> Rows:
    """Return the rows of a sensor's measurements."""
    run = truth.run
    return _linked(
        [
            {
                "token": token(run, "data", sensor.id, frame.number),
                "sample_token": token(run, "sample", frame.number),
                "ego_pose_token": token(run, "ego", frame.number),
                "calibrated_sensor_token": token(run, "calibrated", sensor.id),
                "filename": _file_name(sensor, channel, frame.number),
                "fileformat": "png" if sensor.is_camera else "pcd",
                "width": sensor.width_px,
                "height": sensor.height_px,
                "timestamp": round(frame.t_s * MICROSECONDS),
                "is_key_frame": True,
            }
            for frame in truth.frames
        ]
    )


def _annotations(truth: Truth) -> tuple[Rows, Rows]:
    """Return the annotations, an object once a frame however many sensors saw it, and the instances."""
    by_track: dict[int, dict[int, list[SeenObject]]] = {}
    for each in truth.objects:
        by_track.setdefault(each.track, {}).setdefault(each.frame, []).append(each)
    annotations: Rows = []
    instances: Rows = []
    for track, frames in sorted(by_track.items()):
        rows = _linked([_annotation(truth, views) for _, views in sorted(frames.items())])
        annotations += rows
        instances.append(
            {
                "token": token(truth.run, "instance", track),
                "category_token": token("category", CATEGORY[next(iter(frames.values()))[0].category]),
                "nbr_annotations": len(rows),
                "first_annotation_token": rows[0]["token"],
                "last_annotation_token": rows[-1]["token"],
            }
        )
    return annotations, instances


def _annotation(truth: Truth, views: Sequence[SeenObject]) -> dict[str, Any]:
    """Return the annotation of an object in a frame; the sensor that sees most of it gives its visibility."""
    seen = views[0]
    box, (length, width, height) = right_handed(seen.box), seen.size_m
    share = max((each.visibility for each in views if each.visibility is not None), default=1.0)
    name = _attribute(seen)
    return {
        "token": token(truth.run, "annotation", seen.track, seen.frame),
        "sample_token": token(truth.run, "sample", seen.frame),
        "instance_token": token(truth.run, "instance", seen.track),
        "visibility_token": next(number for below, number, _ in LEVELS if share < below),
        "attribute_tokens": [] if name is None else [token("attribute", name)],
        "translation": translation(box),
        "size": [width, length, height],
        "rotation": quaternion(box),
        "num_lidar_pts": sum(each.cloud_points or 0 for each in views),
        "num_radar_pts": 0,
    }


def _attribute(seen: SeenObject) -> str | None:
    """Return the attribute of an object; None for things that have none."""
    is_moving = math.hypot(*seen.velocity_mps) > MOVING_MPS
    if seen.category in ("car", "truck", "bus"):
        return "vehicle.parked" if seen.is_parked else "vehicle.moving" if is_moving else "vehicle.stopped"
    if seen.category in ("motorcycle", "bicycle"):
        return "cycle.with_rider"
    if seen.category == "pedestrian":
        return "pedestrian.moving" if is_moving else "pedestrian.standing"
    return None


def _linked(rows: Rows) -> Rows:
    """Return rows with the tokens of the rows before and after them."""
    tokens = ["", *(row["token"] for row in rows), ""]
    return [row | {"prev": tokens[index], "next": tokens[index + 2]} for index, row in enumerate(rows)]
