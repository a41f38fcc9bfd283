"""`Declared`: a camera or lidar that a run declared, and its twins, the sensors that report which object is seen."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import carla

from basu.agents.sensor_file import SensorSpec, read_sensors
from basu.errors import UserError
from basu_truth.truth import Pose, Sensor

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

CAMERAS = tuple(f"sensor.camera.{kind}" for kind in ("rgb", "depth", "semantic_segmentation", "instance_segmentation"))
LIDARS = ("sensor.lidar.ray_cast", "sensor.lidar.ray_cast_semantic")
INSTANCES, DEPTH, SEMANTIC_LIDAR = "sensor.camera.instance_segmentation", "sensor.camera.depth", LIDARS[1]
OF_SHAPE = ("image_size_x", "image_size_y", "fov")
"""The attributes of a camera that decide where a thing is in its picture."""
LENS = "lens_circle_multiplier"
"""Above 0, the lens distorts the picture, and straight lines of a box are no straight lines in it."""
OF_RAYS = ("channels", "range", "points_per_second", "rotation_frequency", "upper_fov", "lower_fov", "horizontal_fov")
"""The attributes of a lidar that decide where its rays go."""
ROUNDING = 1e-6


class Declared(NamedTuple):
    """A declared sensor with the attributes of its blueprint."""

    spec: SensorSpec
    sensor: Sensor
    is_whole_turn: bool = True  # of a lidar: each measurement is a whole number of turns

    @property
    def twins(self) -> tuple[str, ...]:
        """The blueprints of its twins."""
        return (INSTANCES, DEPTH) if self.sensor.is_camera else (SEMANTIC_LIDAR,)

    @property
    def transform(self) -> carla.Transform:
        """The pose on the vehicle."""
        return transform_of(self.sensor.pose)


def transform_of(pose: Pose) -> carla.Transform:
    """Return a pose as CARLA has it."""
    place = carla.Location(pose.x_m, pose.y_m, pose.z_m)
    return carla.Transform(place, carla.Rotation(roll=pose.roll_deg, pitch=pose.pitch_deg, yaw=pose.yaw_deg))


def cameras_and_lidars(specs: Iterable[SensorSpec], run: str, source: Path | None) -> tuple[SensorSpec, ...]:
    """Return the cameras and lidars of a run, or of the sensor file ``source`` instead.

    Raises:
        UserError: there is none, or the file cannot be read.
    """
    chosen = tuple(specs) if source is None else read_sensors(source)
    found = tuple(spec for spec in chosen if spec.type_id in (*CAMERAS, *LIDARS))
    if not found:
        where = f"the agent of {run} declared no camera and no lidar" if source is None else f"{source} has none"
        raise UserError(
            f"{where}; name a sensor file with cameras ({', '.join(CAMERAS)}) or lidars ({', '.join(LIDARS)}) "
            "with --sensors FILE.json"
        )
    return found


def declared_sensors(
    specs: Iterable[SensorSpec], library: carla.BlueprintLibrary, step_s: float
) -> tuple[Declared, ...]:
    """Return the sensors with the defaults of their blueprints.

    Raises:
        UserError: a camera has a lens that distorts.
    """
    return tuple(_declared(spec, library, step_s) for spec in specs)


def _declared(spec: SensorSpec, library: carla.BlueprintLibrary, step_s: float) -> Declared:
    """Return one sensor."""
    blueprint, given = library.find(spec.type_id), dict(spec.attributes)

    def value(name: str) -> float:
        if name in given or not blueprint.has_attribute(name):
            return float(given.get(name, "0"))
        attribute = blueprint.get_attribute(name)
        return float(attribute.as_int() if attribute.type == carla.ActorAttributeType.Int else attribute.as_float())

    pose = Pose(spec.x_m, spec.y_m, spec.z_m, spec.roll_deg, spec.pitch_deg, spec.yaw_deg)
    if spec.type_id in LIDARS:
        turns = value("rotation_frequency") * step_s
        whole = round(turns) >= 1 and abs(turns - round(turns)) < ROUNDING
        return Declared(spec, Sensor(id=spec.id, type_id=spec.type_id, pose=pose), whole)
    if value(LENS) > 0.0:
        raise UserError(
            f"camera '{spec.id}' has {LENS} {value(LENS):g}, and a distorted picture has no boxes that calibration "
            f"files could describe; set {LENS} to 0 in a file for --sensors"
        )
    size = int(value("image_size_x")), int(value("image_size_y"))
    return Declared(
        spec,
        Sensor(id=spec.id, type_id=spec.type_id, pose=pose, width_px=size[0], height_px=size[1], fov_deg=value("fov")),
    )


def blueprint_of(
    each: Declared, type_id: str, library: carla.BlueprintLibrary, tick_s: float | None
) -> carla.ActorBlueprint:
    """Return the blueprint of a declared sensor, or of the twin ``type_id`` of it.

    Args:
        each: the declared sensor.
        type_id: its own blueprint, or that of a twin.
        library: of the simulator.
        tick_s: simulated time between two measurements; None: each frame.
    """
    blueprint = library.find(type_id)
    is_itself = type_id == each.spec.type_id
    for name, value in each.spec.attributes:
        if (is_itself or name in OF_SHAPE or name in OF_RAYS) and name != "sensor_tick":
            blueprint.set_attribute(name, value)
    if tick_s is not None:
        blueprint.set_attribute("sensor_tick", f"{tick_s:.6f}")
    return blueprint
