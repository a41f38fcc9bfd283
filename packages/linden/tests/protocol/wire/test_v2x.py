"""Records of messages between vehicles: sizes, places and the bytes that must be zero."""

import struct

from linden.protocol.values.v2x import (
    CooperativeAwarenessMessage,
    CustomMessage,
    DriveDirection,
    ReceivedCam,
    ReceivedText,
    StationType,
    VehicleFacts,
    VehicleRole,
    VehicleState,
)
from linden.protocol.wire.v2x import cam_payload, text_payload

STATE = VehicleState(900, 1, 1234, 2, DriveDirection.BACKWARD, 45, 19, -12, 7, -3, -250, 0x80)
UNIT = CooperativeAwarenessMessage(77, StationType.ROAD_SIDE_UNIT, 65_535, -400_000_000, 830_000_000, 25_000)
CAR = UNIT._replace(station_type=StationType.PASSENGER_CAR, state=STATE, facts=VehicleFacts(VehicleRole.TAXI, 0xA0))
LONGS_BEFORE_OPTIONS = (
    *(2, 2, 77, 65_535, 5, -400_000_000, 830_000_000, 4095, 4095, 3601, 25_000, 15, 1),
    *(900, 1, 1234, 2, 1, 45, 0, 19, -12, 102, 1023, 7, 2, -250, 8),
)


def test_a_cam_is_where_the_clients_struct_has_it() -> None:
    (records,) = cam_payload([ReceivedCam(-61.5, CAR), ReceivedCam(-70.0, UNIT)])
    data = records.tobytes()
    assert len(data) == 2 * 464
    assert struct.unpack_from("<f4x28q", data) == (-61.5, *LONGS_BEFORE_OPTIONS)
    assert struct.unpack_from("<2B", data, 232) == (1, 0x80)
    assert struct.unpack_from("<B7x2q", data, 272) == (1, 7, 102)
    assert struct.unpack_from("<B7x2q", data, 296) == (1, -3, 102)
    assert struct.unpack_from("<2qB", data, 408) == (1, VehicleRole.TAXI, 0xA0)
    unit = data[464:]
    assert struct.unpack_from("<q", unit, 104) == (2,)
    for message in (data[:464], unit):
        assert message[376:408] == bytes(32)  # the protected zones, which hold pointers in the client
        assert message[432:464] == bytes(32)  # the path history likewise


def test_a_text_ends_with_a_zero() -> None:
    (records,) = text_payload([ReceivedText(-50.0, CustomMessage(9, "ü" * 49 + "x"))])
    data = records.tobytes()
    assert len(data) == 136
    assert struct.unpack_from("<f4x3q", data) == (-50.0, 2, 0, 9)
    assert data[32:131].decode() == "ü" * 49 + "x"
    assert data[131:] == bytes(5)
