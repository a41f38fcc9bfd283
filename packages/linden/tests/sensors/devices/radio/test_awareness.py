"""What a station tells stays within the limits of the message, whatever the station does."""

import pytest

from linden.protocol.values.space import GeoLocation, Vector3D
from linden.protocol.values.v2x import StationType
from linden.sensors.devices.attributes import GnssSpec
from linden.sensors.devices.radio.awareness import Place, Telling, awareness
from linden.sensors.devices.radio.spec import CamErrors

WILD = 1e7
LIMITS = {
    "heading": (0, 3599),
    "speed": (0, 16_382),
    "length": (1, 1022),
    "width": (1, 61),
    "longitudinal_acceleration": (-160, 160),
    "lateral_acceleration": (-160, 160),
    "vertical_acceleration": (-160, 160),
    "yaw_rate": (-32_766, 32_766),
}
"""TS 102 894-2 V1.3.1, without the values that mean "unavailable"."""


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_wild_values_are_the_last_that_can_be_told(sign: float) -> None:
    far = sign * WILD
    telling = Telling(
        far, far, Vector3D(far, far, far), far, length_m=WILD, width_m=WILD, brakes=True, accelerates=True
    )
    errors = CamErrors(position=GnssSpec(bias=GeoLocation(far, far, far)))
    message = awareness(Place(1, StationType.UNKNOWN, 70.0, Vector3D(), (40.0, -83.0)), telling, None, errors, 0)
    state = message.state
    assert state is not None
    assert all(least <= getattr(state, name) <= most for name, (least, most) in LIMITS.items())
    at_limits = [getattr(state, name) in limits for name, limits in LIMITS.items() if name != "heading"]
    assert all(at_limits)
    assert message.generation_delta_time == 70_000 - 65_536
    assert (abs(message.latitude), abs(message.longitude)) == (900_000_000, 1_800_000_000)
    assert message.altitude in (-100_000, 800_000)
