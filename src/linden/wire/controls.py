"""A vehicle's control as clients send it: the one struct in which a number that is none must do no harm.

The official client's Traffic Manager divides by a target speed that may be zero and then sends a brake of NaN; it ends
the whole client when such a batch is refused. CARLA lets the number through to Unreal's ``FMath::Clamp``, which makes
NaN the upper end of the range: full brake.
"""

import math
from typing import Annotated

from linden.values.vehicles import VehicleControl
from linden.wire.decode import DecodedBy, struct_decoder

_STRICT = struct_decoder(VehicleControl)
_PEDALS_AND_WHEEL = 3
_FULL = 1.0


def decode_control(raw: object) -> VehicleControl:
    """Return a control; of throttle, steer and brake NaN means full, and an infinite one the end of its range.

    Raises:
        WireTypeError: it is no control.
    """
    if type(raw) is list:
        tamed = [_tamed(value) for value in raw[:_PEDALS_AND_WHEEL]]
        raw = [*tamed, *raw[_PEDALS_AND_WHEEL:]]
    control: VehicleControl = _STRICT(raw)
    return control


def _tamed(value: object) -> object:
    if type(value) is not float or math.isfinite(value):
        return value
    return -_FULL if value == -math.inf else _FULL


ClientControl = Annotated[VehicleControl, DecodedBy(decode_control)]
"""The annotation of a control that comes from a client."""
