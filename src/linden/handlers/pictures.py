"""How what cameras measured goes over the wire."""

from linden.sensors.camera.cameras import Image
from linden.sensors.camera.events import Events
from linden.simulation import Simulation
from linden.simulation.measuring import Measurement
from linden.wire.headers import SensorType
from linden.wire.images import events_payload, image_payload
from linden.wire.stream import Parts

_KINDS = {
    "sensor.camera.depth": SensorType.CAMERA_DEPTH,
    "sensor.camera.normals": SensorType.CAMERA_NORMALS,
    "sensor.camera.optical_flow": SensorType.CAMERA_OPTICAL_FLOW,
    "sensor.camera.rgb": SensorType.CAMERA_RGB,
    "sensor.camera.semantic_segmentation": SensorType.CAMERA_SEMANTIC,
    "sensor.camera.instance_segmentation": SensorType.CAMERA_INSTANCE,
}


def image(_simulation: Simulation, _measurement: Measurement, reading: Image) -> tuple[SensorType, Parts]:
    """Encode a picture."""
    return _KINDS[reading.blueprint], image_payload(reading.pixels, reading.fov_deg)


def events(_simulation: Simulation, _measurement: Measurement, reading: Events) -> tuple[SensorType, Parts]:
    """Encode the events of an event camera."""
    return SensorType.CAMERA_DVS, events_payload(reading.events, reading.width_px, reading.height_px, reading.fov_deg)
