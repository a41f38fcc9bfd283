"""Controls with numbers that are none, as the Traffic Manager sends them."""

import math

import pytest

from linden.protocol.values.control import VehicleControl
from linden.protocol.wire.commands import ApplyVehicleControl, decode_commands
from linden.protocol.wire.controls import decode_control
from linden.protocol.wire.decode import WireTypeError

TAIL = [False, False, False, 0]


@pytest.mark.parametrize(("sent", "held"), [(math.nan, 1.0), (math.inf, 1.0), (-math.inf, -1.0), (0.25, 0.25)])
def test_what_is_no_number_is_the_end_of_the_range_that_unreal_makes_of_it(sent: float, held: float) -> None:
    assert decode_control([sent, sent, sent, *TAIL]) == VehicleControl(held, held, held)


def test_a_brake_that_is_no_number_spoils_no_batch() -> None:
    batch = [[[2, [7, [0.0, 0.1, math.nan, *TAIL]]]], [[2, [8, [0.5, 0.0, 0.0, *TAIL]]]]]
    assert decode_commands(batch) == (
        ApplyVehicleControl(7, VehicleControl(0.0, 0.1, 1.0)),
        ApplyVehicleControl(8, VehicleControl(0.5)),
    )


@pytest.mark.parametrize("raw", [[0.0, 0.0, "full", *TAIL], [0.0, 0.0, 1e300, *TAIL], {"brake": 1.0}, None])
def test_what_is_no_control_is_still_refused(raw: object) -> None:
    with pytest.raises(WireTypeError):
        decode_control(raw)
