"""`ShardWriter`: the frames of one drive as samples in tar files, after the convention of WebDataset.

A sample is a run of neighbouring files with one key: ``KEY.json`` (frame and objects), ``KEY.SENSOR.png`` for each
camera and ``KEY.SENSOR.npy`` for each lidar. Source: https://huggingface.co/docs/hub/datasets-webdataset and the
readme of webdataset 1.0.2. Equal frames give equal bytes: names in one order, no times, no owners.
"""

from __future__ import annotations

import io
import json
import re
import tarfile
from dataclasses import asdict
from typing import TYPE_CHECKING

import numpy as np

from basu.errors import UserError
from basu_truth.clouds import points_of
from basu_truth.geometry import pose_of
from basu_truth.pictures import png_of
from basu_truth.rig import CAMERAS, LIDARS
from basu_truth.truth import TruthFrame, rounded

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    import carla

    from basu.agents.sensor_file import SensorSpec
    from basu_truth.scene import Shot
    from basu_truth.truth import SeenObject, Sensor, Truth

SAMPLE = "json"  # the ending of the file with frame and objects


class ShardWriter:
    """Writes the shards of one drive into its folder."""

    def __init__(self, folder: Path, sensors: Sequence[Sensor], *, drive: str, per_shard: int) -> None:
        """Take the folder of the drive.

        Args:
            folder: the folder for the tar files; it must exist.
            sensors: the cameras and lidars of the drive.
            drive: the beginning of all keys and names of shards, unique in the data set.
            per_shard: samples of a full shard, 1 or more.

        Raises:
            UserError: two sensors would have files of one name.
        """
        self._folder, self._sensors, self._drive, self._per_shard = folder, sensors, drive, per_shard
        self._endings = file_endings(sensors)
        self._tar: tarfile.TarFile | None = None
        self._samples = 0

    def write(self, shot: Shot, objects: Sequence[SeenObject]) -> None:
        """Write a frame as a sample."""
        if self._samples % self._per_shard == 0:
            self._close()
            name = f"{self._drive}-{self._samples // self._per_shard:04d}.tar"
            self._tar = tarfile.open(self._folder / name, "w", format=tarfile.USTAR_FORMAT)  # noqa: SIM115 - in `_close`
        frame = TruthFrame(number=shot.number, t_s=shot.t_s, ego=pose_of(shot.ego), weather=dict(shot.weather))
        document = {
            "drive": self._drive,
            "frame": asdict(frame),
            "sensors": [{**asdict(each), "file": self._endings[each.id]} for each in self._sensors],
            "objects": [asdict(each) for each in objects],
        }
        key = f"{self._drive}-{shot.number:06d}"
        text = json.dumps(rounded(document), separators=(",", ":"))
        files = {f"{key}.{SAMPLE}": text.encode()}
        for each in self._sensors:
            measured = shot.measured[each.id][each.type_id]
            content = png_of(measured) if each.is_camera else _npy(measured, is_semantic=each.type_id == LIDARS[1])
            files[f"{key}.{self._endings[each.id]}"] = content
        for name, content in sorted(files.items()):
            self._add(name, content)
        self._samples += 1

    def finish(self, truth: Truth) -> None:  # noqa: ARG002 - each sample has its part of the truth
        """Close the last shard of the drive, which may have fewer samples than the others."""
        self._close()

    def _add(self, name: str, content: bytes) -> None:
        """Add a file without time and owner."""
        assert self._tar is not None, "a shard is open"
        entry = tarfile.TarInfo(name)
        entry.size = len(content)
        self._tar.addfile(entry, io.BytesIO(content))

    def _close(self) -> None:
        if self._tar is not None:
            self._tar.close()
            self._tar = None


def file_endings(sensors: Iterable[Sensor | SensorSpec]) -> dict[str, str]:
    """Return what follows a key in the name of each sensor's file, by the sensor's id, such as ``front.png``.

    Raises:
        UserError: two sensors would have files of one name.
    """
    found: dict[str, str] = {}
    for each in sensors:
        ending = f"{re.sub(r'[^a-z0-9_-]', '-', each.id.lower())}.{'png' if each.type_id in CAMERAS else 'npy'}"
        other = next((name for name, taken in found.items() if taken == ending), None)
        if other is not None:
            raise UserError(
                f"the sensors '{other}' and '{each.id}' would both write files that end with .{ending}; give them ids "
                "that differ in more than upper case and signs"
            )
        found[each.id] = ending
    return found


def _npy(measured: carla.LidarMeasurement | carla.SemanticLidarMeasurement, *, is_semantic: bool) -> bytes:
    """Return the points (N, 4) of a lidar as a file of numpy: x, y, z in m in the sensor's frame, and intensity."""
    stream = io.BytesIO()
    np.save(stream, points_of(measured, is_semantic=is_semantic))
    return stream.getvalue()
