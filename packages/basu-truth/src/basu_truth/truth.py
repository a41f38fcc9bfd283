"""`Truth`: the objects that sensors saw in the frames of a run, and its file ``truth.json``.

All places are in CARLA's frames: m, left-handed, x forward (world: east), y right (world: south), z up; angles in
degrees, yaw clockwise from above.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import UserError
from basu.files import read_json, write_bytes

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

TRUTH_FILE = "truth.json"
VERSION = 1

CLASSES = ("car", "truck", "bus", "motorcycle", "bicycle", "pedestrian", "animal", "traffic_cone", "barrier")
"""The classes of objects, in the order of their numbers in the files of formats that number them."""


class Pose(NamedTuple):
    """A place and an attitude: m and degrees."""

    x_m: float
    y_m: float
    z_m: float
    roll_deg: float
    pitch_deg: float
    yaw_deg: float


class Rectangle(NamedTuple):
    """A part of a picture in pixels; the left upper corner of the picture is (0, 0)."""

    left: float
    top: float
    width: float
    height: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensor:
    """A camera or a lidar of the vehicle under test; the sizes of a lidar's picture are 0."""

    id: str
    type_id: str
    pose: Pose  # in the vehicle's frame
    width_px: int = 0
    height_px: int = 0
    fov_deg: float = 0.0  # across the picture

    @property
    def is_camera(self) -> bool:
        """Whether the sensor makes pictures."""
        return self.type_id.startswith("sensor.camera.")


@dataclass(frozen=True, slots=True, kw_only=True)
class TruthFrame:
    """One exported frame."""

    number: int  # of the recording, from 1
    t_s: float  # of simulated time since the first frame of the recording
    ego: Pose  # of the vehicle's origin in the world
    weather: Mapping[str, float]  # of carla.WeatherParameters in its units; empty: the map's own


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenObject:
    """One object as one sensor saw it in one frame.

    Attributes:
        frame: the number of the frame.
        sensor: the id of the sensor.
        track: the same number for the same object in all frames and sensors.
        category: one of ``CLASSES``.
        model: the blueprint, or the name of a thing of the map.
        box: middle and attitude of the box in the world.
        box_in_sensor: the same in the sensor's frame.
        size_m: length, width and height of the box.
        velocity_mps: of the object over ground, in the world's axes.
        distance_m: from the sensor to the middle of the box.
        visible: pixels or lidar points of the object.
        whole: pixels or points that the object would have without anything in front of it; None where that was not
            measured.
        hidden_by_actors: the pixels that another actor or the own vehicle covers.
        hidden_by_scenery: the pixels that houses, trees, parked cars and other things of the map cover.
        rectangle: the smallest rectangle around the visible pixels; None for a lidar.
        whole_rectangle: the same around all pixels that the object would have in the picture; None for a lidar.
        truncation: the share of the projected box that is outside of the picture; None for a lidar.
        cloud_points: of a lidar, the points of the object in the cloud that the declared lidar made, with its losses.
        in_range: whether light and air let a driver see so far: ``basu.agents.sight.line_of_sight``.
        is_parked: whether the object is a thing of the map and not an actor.
    """

    frame: int
    sensor: str
    track: int
    category: str
    model: str
    box: Pose
    box_in_sensor: Pose
    size_m: tuple[float, float, float]
    velocity_mps: tuple[float, float, float]
    distance_m: float
    visible: int
    whole: int | None
    hidden_by_actors: int = 0
    hidden_by_scenery: int = 0
    rectangle: Rectangle | None = None
    whole_rectangle: Rectangle | None = None
    truncation: float | None = None
    cloud_points: int | None = None
    in_range: bool = True
    is_parked: bool = False

    @property
    def visibility(self) -> float | None:
        """The visible share of the object, 0 to 1; None where it was not measured."""
        return None if self.whole is None else self.visible / max(self.whole, 1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Truth:
    """The truth of a run, as far as it was exported."""

    run: str
    town: str
    step_s: float  # of simulated time between two frames of the recording
    every: int  # of the recording's frames, each so manyth was exported
    sensors: tuple[Sensor, ...]
    frames: tuple[TruthFrame, ...]
    objects: tuple[SeenObject, ...] = field(default=())

    def sensor(self, sensor_id: str) -> Sensor:
        """Return a sensor by its id.

        Raises:
            UserError: there is none of that id.
        """
        found = next((each for each in self.sensors if each.id == sensor_id), None)
        if found is None:
            raise UserError(
                f"the truth of {self.run} has no sensor '{sensor_id}'; it has {', '.join(s.id for s in self.sensors)}"
            )
        return found


def write_truth(folder: Path, truth: Truth) -> None:
    """Write ``truth.json`` into a folder."""
    document = {"version": VERSION, **rounded(asdict(truth))}
    write_bytes(folder / TRUTH_FILE, (json.dumps(document, separators=(",", ":")) + "\n").encode())


def read_truth(folder: Path) -> Truth:
    """Read the truth that an export wrote.

    Raises:
        UserError: the file is not there, or is no such document.
    """
    path = folder / TRUTH_FILE
    document = read_json(path, "ground truth")
    try:
        if document["version"] != VERSION:
            raise UserError(f"{path} has version {document['version']}; this program reads {VERSION}: export it again")
        return Truth(
            run=document["run"],
            town=document["town"],
            step_s=document["step_s"],
            every=document["every"],
            sensors=tuple(Sensor(**{**each, "pose": Pose(*each["pose"])}) for each in document["sensors"]),
            frames=tuple(TruthFrame(**{**each, "ego": Pose(*each["ego"])}) for each in document["frames"]),
            objects=tuple(object_of(each) for each in document["objects"]),
        )
    except (KeyError, TypeError) as error:
        raise UserError(f"{path} is not what `basu truth export` writes: {error!r}; export the run again") from error


def object_of(entry: Mapping[str, Any]) -> SeenObject:
    """Return an object of the document, or of a sample of a data set."""
    values = {each.name: entry[each.name] for each in fields(SeenObject)}
    for name in ("box", "box_in_sensor"):
        values[name] = Pose(*values[name])
    for name in ("size_m", "velocity_mps"):
        values[name] = tuple(values[name])
    for name in ("rectangle", "whole_rectangle"):
        values[name] = None if values[name] is None else Rectangle(*values[name])
    return SeenObject(**values)


def rounded(value: Any) -> Any:  # noqa: ANN401 - a document of JSON
    """Return a document with its numbers to the micrometre and the millionth of a degree."""
    if isinstance(value, dict):
        return {key: rounded(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(each) for each in value]
    return round(value, 6) if isinstance(value, float) else value
