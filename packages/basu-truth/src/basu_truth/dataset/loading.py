"""`samples`: streams the samples of a data set, one at a time, in the order of its shards.

Any program that reads WebDataset reads the shards too. This reader needs nothing beside numpy and Pillow, and returns
objects as `basu_truth.truth` has them.
"""

from __future__ import annotations

import io
import itertools
import json
import tarfile
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from basu.errors import UserError
from basu_truth.dataset.dataset_batch import SHARDS_FILE
from basu_truth.dataset.shards import SAMPLE
from basu_truth.truth import Pose, SeenObject, Sensor, TruthFrame, object_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """One frame of one drive.

    Attributes:
        key: unique in the data set.
        frame: number, time, pose of the vehicle under test and weather.
        sensors: the cameras and lidars, by id.
        pictures: (height, width, 3) red, green and blue of each camera, by id.
        clouds: (N, 4) x, y, z in m in the sensor's frame, and intensity, of each lidar, by id.
        objects: what each sensor saw.
    """

    key: str
    frame: TruthFrame
    sensors: Mapping[str, Sensor]
    pictures: Mapping[str, NDArray[np.uint8]]
    clouds: Mapping[str, NDArray[np.float32]]
    objects: tuple[SeenObject, ...]


def samples(folder: Path) -> Iterator[Sample]:
    """Yield all samples of a data set; one sample is in memory at a time.

    Raises:
        UserError: the folder is no data set, a shard is not there, or it is damaged.
    """
    try:
        names = (folder / SHARDS_FILE).read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise UserError(
            f"{folder} has no {SHARDS_FILE}: {error.strerror}; name a folder that `basu record dataset` has finished"
        ) from error
    for name in names:
        yield from _of_shard(folder / name)


def _of_shard(path: Path) -> Iterator[Sample]:
    """Yield the samples of a shard.

    Raises:
        UserError: it cannot be read.
    """
    try:
        with tarfile.open(path, "r|") as tar:
            files = ((entry.name, _content(tar, entry)) for entry in tar)
            for key, group in itertools.groupby(files, lambda each: each[0].partition(".")[0]):
                yield _sample(key, {file.partition(".")[2]: content for file, content in group})
    except (OSError, tarfile.TarError, KeyError, TypeError, ValueError) as error:
        raise UserError(f"the shard {path} cannot be read: {error}; record the data set again") from error


def _content(tar: tarfile.TarFile, entry: tarfile.TarInfo) -> bytes:
    """Return the bytes of a file of a shard."""
    stream = tar.extractfile(entry)
    if stream is None:
        raise ValueError(f"{entry.name} is no file")
    return stream.read()


def _sample(key: str, files: Mapping[str, bytes]) -> Sample:
    """Return a sample of its files, by what follows the key in their names."""
    document: dict[str, Any] = json.loads(files[SAMPLE])
    sensors, pictures, clouds = {}, {}, {}
    for entry in document["sensors"]:
        content = files[entry.pop("file")]
        sensor = Sensor(**{**entry, "pose": Pose(*entry["pose"])})
        sensors[sensor.id] = sensor
        if sensor.is_camera:
            pictures[sensor.id] = np.asarray(Image.open(io.BytesIO(content)))
        else:
            clouds[sensor.id] = np.load(io.BytesIO(content))
    frame = document["frame"]
    return Sample(
        key=key,
        frame=TruthFrame(**{**frame, "ego": Pose(*frame["ego"])}),
        sensors=sensors,
        pictures=pictures,
        clouds=clouds,
        objects=tuple(object_of(each) for each in document["objects"]),
    )
