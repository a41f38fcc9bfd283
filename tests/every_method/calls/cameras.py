"""Events of the sensors that see: images, optical flow, brightness events, point clouds, radar echoes."""

from typing import Any

import carla
import pytest

from every_method.call import Call, Defect
from every_method.entries import comparisons, fields, vector
from every_method.stage import Stage

SMALL = {"image_size_x": "32", "image_size_y": "16"}


def image(stage: Stage) -> Any:
    """What a camera sees."""
    return stage.event("sensor.camera.rgb", **SMALL)


def flow(stage: Stage) -> Any:
    """How what it sees moves."""
    return stage.event("sensor.camera.optical_flow", **SMALL)


def flashes(stage: Stage) -> Any:
    """Where it becomes brighter or darker."""
    return stage.event("sensor.camera.dvs", lambda: shake(stage), **SMALL)


def shake(stage: Stage) -> None:
    """Let the camera move."""
    stage.vehicle.set_target_velocity(stage.vehicle.get_transform().get_forward_vector() * 5.0)


def cloud(stage: Stage) -> Any:
    """What a lidar hits."""
    return stage.event("sensor.lidar.ray_cast")


def labelled_cloud(stage: Stage) -> Any:
    """What a lidar hits, and what it is."""
    return stage.event("sensor.lidar.ray_cast_semantic")


def echoes(stage: Stage) -> Any:
    """What a radar hears."""
    return stage.event("sensor.other.radar")


def on_disk(stage: Stage, event: Any, name: str) -> bool:
    """Whether an event is written to disk."""
    return len(str(event.save_to_disk(str(stage.folder / name)))) > 0


def array(owner: str, of: Any) -> dict[str, Call]:
    """Return the rows of an event that is a list."""

    def replaced(stage: Stage) -> None:
        event = of(stage)
        event[0] = event[0]

    return {
        f"{owner}.__len__": lambda s: len(of(s)) > 0,
        f"{owner}.__getitem__": lambda s: of(s)[0] is not None,
        f"{owner}.__iter__": lambda s: next(iter(of(s))) is not None,
        f"{owner}.__setitem__": replaced,
        f"{owner}.__str__": lambda s: len(str(of(s))) > 0,
        f"{owner}.raw_data": lambda s: len(of(s).raw_data) > 0,
    }


def size(owner: str, of: Any) -> dict[str, Call]:
    """Return the rows of an event that is a picture."""
    return fields(owner, of, width=32, height=16, fov=90.0)


def painted(stage: Stage) -> Any:
    """The picture that the client makes of brightness events: a list of pixels of its own class."""
    return flashes(stage).to_image()


def flow_picture(stage: Stage) -> Any:
    """The picture that the client makes of optical flow, in a class of its own."""
    return flow(stage).get_color_coded_flow()


def points(owner: str, of: Any, folder: str) -> dict[str, Call]:
    """Return the rows of a point cloud."""
    return {
        **array(owner, of),
        f"{owner}.channels": lambda s: of(s).channels == 32,
        f"{owner}.horizontal_angle": lambda s: abs(of(s).horizontal_angle) < 7.0,
        f"{owner}.get_point_count": lambda s: sum(of(s).get_point_count(beam) for beam in range(32)) == len(of(s)),
        f"{owner}.save_to_disk": lambda s: on_disk(s, of(s), folder),
    }


CALLS: dict[str, Call] = {
    **array("Image", image),
    **size("Image", image),
    "Image.convert": lambda s: image(s).convert(carla.ColorConverter.CityScapesPalette),
    "Image.save_to_disk": lambda s: on_disk(s, image(s), "image.png"),
    **array("OpticalFlowImage", flow),
    **size("OpticalFlowImage", flow),
    "OpticalFlowImage.get_color_coded_flow": lambda s: isinstance(flow_picture(s), carla.FakeImage),
    "OpticalFlowPixel.__init__": lambda _: carla.OpticalFlowPixel(1.0).y == 0.0,
    **fields("OpticalFlowPixel", lambda _: carla.OpticalFlowPixel(1.0, 2.0), x=1.0, y=2.0),
    **comparisons("OpticalFlowPixel", lambda: carla.OpticalFlowPixel(1.0), carla.OpticalFlowPixel),
    "FakeImage.width": lambda s: flow_picture(s).width == 32,
    "FakeImage.height": lambda s: flow_picture(s).height == 16,
    "FakeImage.fov": lambda s: flow_picture(s).fov == pytest.approx(90.0),
    "FakeImage.raw_data": lambda s: len(flow_picture(s).raw_data) == 4 * 32 * 16,
    **{
        member: Defect(call, "ArgumentError", "its pixels are bytes to the client, and their list has no Python class")
        for member, call in vector("FakeImage", flow_picture, carla.Color).items()
        if member not in ("FakeImage.__init__", "FakeImage.__str__")  # the client alone makes it, and prints no more
    },
    **array("DVSEventArray", flashes),
    **size("DVSEventArray", flashes),
    "DVSEventArray.to_image": lambda s: painted(s) is not None,
    "DVSEventArray.to_array": Defect(
        lambda s: flashes(s).to_array(), "TypeError", "its rows are a list of lists, which has no Python class"
    ),
    "DVSEventArray.to_array_x": lambda s: len(flashes(s).to_array_x()) == len(flashes(s)),
    "DVSEventArray.to_array_y": lambda s: len(flashes(s).to_array_y()) == len(flashes(s)),
    "DVSEventArray.to_array_t": lambda s: len(flashes(s).to_array_t()) == len(flashes(s)),
    "DVSEventArray.to_array_pol": lambda s: len(flashes(s).to_array_pol()) == len(flashes(s)),
    "DVSEvent.__init__": lambda _: isinstance(carla.DVSEvent(), carla.DVSEvent),
    **fields(
        "DVSEvent",
        lambda s: flashes(s)[0],
        x=lambda at: 0 <= at < 32,
        y=lambda at: 0 <= at < 16,
        t=lambda when_ns: when_ns > 0,
        pol=lambda brighter: isinstance(brighter, bool),
    ),
    "DVSEvent.__str__": lambda _: len(str(carla.DVSEvent())) > 0,
    **points("LidarMeasurement", cloud, "cloud.ply"),
    "LidarDetection.__init__": lambda _: isinstance(carla.LidarDetection(), carla.LidarDetection),
    **fields(
        "LidarDetection",
        lambda s: cloud(s)[0],
        point=lambda place: place.length() <= 10.5,
        intensity=lambda share: 0.0 <= share <= 1.0,
    ),
    "LidarDetection.__str__": lambda _: len(str(carla.LidarDetection())) > 0,
    **points("SemanticLidarMeasurement", labelled_cloud, "labelled_cloud.ply"),
    "SemanticLidarDetection.__init__": lambda _: isinstance(
        carla.SemanticLidarDetection(), carla.SemanticLidarDetection
    ),
    **fields(
        "SemanticLidarDetection",
        lambda s: labelled_cloud(s)[0],
        point=lambda place: place.length() <= 10.5,
        cos_inc_angle=lambda cosine: -1.01 <= cosine <= 1.01,
        object_idx=lambda number: number >= 0,
        object_tag=lambda tag: 0 <= tag <= 28,
    ),
    "SemanticLidarDetection.__str__": lambda _: len(str(carla.SemanticLidarDetection())) > 0,
    **array("RadarMeasurement", echoes),
    "RadarMeasurement.get_detection_count": lambda s: echoes(s).get_detection_count() == len(echoes(s)),
    "RadarDetection.__init__": lambda _: isinstance(carla.RadarDetection(), carla.RadarDetection),
    **fields(
        "RadarDetection",
        lambda s: echoes(s)[0],
        velocity=lambda mps: abs(mps) < 50.0,
        azimuth=lambda rad: abs(rad) < 1.6,
        altitude=lambda rad: abs(rad) < 1.6,
        depth=lambda far_m: 0.0 <= far_m <= 100.5,
    ),
    "RadarDetection.__str__": lambda _: len(str(carla.RadarDetection())) > 0,
}
