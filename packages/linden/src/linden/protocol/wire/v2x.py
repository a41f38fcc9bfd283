"""Messages between vehicles as the records that sensors 20 and 21 send: C structs, one after the other, uncounted.

Sources, LibCarla 0.9.16: ``carla/sensor/data/V2XData.h`` and ``LibITS.h``. Every integer there is a C ``long``. The
protected zones of a road side unit and the path history are C++ vectors inside the struct. Their bytes must be zero, or
the client follows pointers of another process.
"""

from collections.abc import Sequence

import numpy as np

from linden.protocol.values.v2x import PROTOCOL_VERSION, MessageId, ReceivedCam, ReceivedText
from linden.protocol.wire.measurements import Parts
from linden.structured import StructuredArray

_LONG = "<i8"
_HEADER = {"power": (0, "<f4"), "protocol_version": (8, _LONG), "message_id": (16, _LONG), "station_id": (24, _LONG)}
_CAM = {
    **_HEADER,
    "generation_delta_time": (32, _LONG),
    "station_type": (40, _LONG),
    "latitude": (48, _LONG),
    "longitude": (56, _LONG),
    "semi_major_confidence": (64, _LONG),
    "semi_minor_confidence": (72, _LONG),
    "semi_major_orientation": (80, _LONG),
    "altitude": (88, _LONG),
    "altitude_confidence": (96, _LONG),
    "high_frequency_container": (104, _LONG),  # 0 none, 1 of a vehicle, 2 of a road side unit
    "heading": (112, _LONG),
    "heading_confidence": (120, _LONG),
    "speed": (128, _LONG),
    "speed_confidence": (136, _LONG),
    "drive_direction": (144, _LONG),
    "length": (152, _LONG),
    "length_confidence": (160, _LONG),
    "width": (168, _LONG),
    "longitudinal_acceleration": (176, _LONG),
    "longitudinal_acceleration_confidence": (184, _LONG),
    "curvature": (192, _LONG),
    "curvature_confidence": (200, _LONG),
    "curvature_calculation_mode": (208, _LONG),
    "yaw_rate": (216, _LONG),
    "yaw_rate_confidence": (224, _LONG),
    "has_acceleration_control": (232, "u1"),
    "acceleration_control": (233, "u1"),
    "has_lateral_acceleration": (272, "u1"),
    "lateral_acceleration": (280, _LONG),
    "lateral_acceleration_confidence": (288, _LONG),
    "has_vertical_acceleration": (296, "u1"),
    "vertical_acceleration": (304, _LONG),
    "vertical_acceleration_confidence": (312, _LONG),
    "low_frequency_container": (408, _LONG),  # 0 none, 1 of a vehicle
    "vehicle_role": (416, _LONG),
    "exterior_lights": (424, "u1"),
}
_TEXT = {**_HEADER, "text": (32, "S100")}


def _record(fields: dict[str, tuple[int, str]], size_bytes: int) -> "np.dtype[np.void]":
    offsets, formats = zip(*fields.values(), strict=True)
    layout = {"names": list(fields), "formats": list(formats), "offsets": list(offsets), "itemsize": size_bytes}
    return np.dtype(layout)  # type: ignore[call-overload,no-any-return] # numpy's stubs want literals


CAM_RECORD = _record(_CAM, 464)
TEXT_RECORD = _record(_TEXT, 136)

_UNKNOWN = {
    "semi_major_confidence": 4095,
    "semi_minor_confidence": 4095,
    "semi_major_orientation": 3601,
    "altitude_confidence": 15,
}
"""Of every station: the values by which TS 102 894-2 says that something is unavailable."""
_UNKNOWN_OF_VEHICLES = {
    "longitudinal_acceleration_confidence": 102,
    "lateral_acceleration_confidence": 102,
    "vertical_acceleration_confidence": 102,
    "curvature": 1023,
    "curvature_confidence": 7,
    "curvature_calculation_mode": 2,
    "yaw_rate_confidence": 8,
}
"""Likewise, of vehicles. Confidence 0 of the length means that there is no trailer."""


def cam_payload(received: Sequence[ReceivedCam]) -> Parts:
    """Return the records of cooperative awareness messages."""
    records = np.zeros(len(received), CAM_RECORD)
    for record, (power_dbm, message) in zip(records, received, strict=True):
        _write_header(record, power_dbm, MessageId.CAM, message.station_id)
        for name in ("generation_delta_time", "station_type", "latitude", "longitude", "altitude"):
            record[name] = getattr(message, name)
        _write(record, _UNKNOWN)
        record["high_frequency_container"] = 2 if message.state is None else 1
        if message.state is not None:
            _write(record, {**message.state._asdict(), **_UNKNOWN_OF_VEHICLES})
            for name in ("acceleration_control", "lateral_acceleration", "vertical_acceleration"):
                record[f"has_{name}"] = 1
        if message.facts is not None:
            record["low_frequency_container"] = 1
            record["vehicle_role"], record["exterior_lights"] = message.facts
    return (records,)


def text_payload(received: Sequence[ReceivedText]) -> Parts:
    """Return the records of custom messages."""
    records = np.zeros(len(received), TEXT_RECORD)
    for record, (power_dbm, message) in zip(records, received, strict=True):
        _write_header(record, power_dbm, MessageId.CUSTOM, message.station_id)
        record["text"] = message.text.encode()
    return (records,)


def _write_header(record: StructuredArray, power_dbm: float, message_id: MessageId, station_id: int) -> None:
    record["power"], record["protocol_version"] = power_dbm, PROTOCOL_VERSION
    record["message_id"], record["station_id"] = message_id, station_id


def _write(record: StructuredArray, values: dict[str, int]) -> None:
    for name, value in values.items():
        record[name] = value
