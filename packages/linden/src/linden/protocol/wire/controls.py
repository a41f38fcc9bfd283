"""Vehicle controls and transforms as clients send them: one at a time, and many of a batch as columns.

A NaN in a vehicle control must do no harm. The official client's Traffic Manager divides by a target speed that may be
zero, and then sends a brake of NaN. It ends the whole client when such a batch is refused. CARLA passes the number to
Unreal's ``FMath::Clamp``, which makes NaN the upper end of the range: full brake.

A script for many actors sends a batch with one control or transform for each actor in every tick. Such a batch is read
column by column. Unusual batches go to the decoders of :mod:`linden.protocol.wire.commands`. Those decode command by
command and name what does not fit.
"""

import math
from math import hypot
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.protocol.values.control import VehicleControl
from linden.protocol.wire.decode import DecodedBy, struct_decoder

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


LARGEST_PLACE = 1e9
"""Metres and degrees; a transform with more is unusual and is read by itself."""
WORTH_COLUMNS = 8
"""Commands of one kind in a row from which this is quicker than one after the other."""
LARGEST_ID = 2**32 - 1
LARGEST_PLAIN = 2**31 - 1
"""Pedals, wheel and gear are far below."""
CONTROL_FIELDS = len(VehicleControl._fields)

_TYPES = tuple(VehicleControl.__annotations__[name] for name in VehicleControl._fields)


class Controls(NamedTuple):
    """Controls of vehicles in the order in which they came, none of them unusual."""

    actor_ids: NDArray[np.int64]
    """(K,)"""
    fields: NDArray[np.float64]
    """(K, 7) in the order of VehicleControl."""


class Transforms(NamedTuple):
    """Transforms of actors in the order in which they came, none of them unusual."""

    actor_ids: tuple[int, ...]
    transforms: tuple[Any, ...]
    """For each x, y, z in m and pitch, yaw, roll in degrees."""


def plain_controls(raw: list[Any]) -> Controls | None:
    """Return actors and controls of commands that have the index of a control, None where one of them is unusual.

    Plain are those of which every field has the very type it is sent with, none missing, and no number is too large:
    none in a column is larger than the root of the sum of their squares, which is NaN where one of them is.
    """
    try:
        ids, controls = _ids_and_bodies(raw)
        if {*map(type, controls)} != {list} or {*map(len, controls)} != {CONTROL_FIELDS}:
            return None
        for column, kind in zip(zip(*controls, strict=True), _TYPES, strict=True):
            if {*map(type, column)} != {kind} or (kind is not bool and not hypot(*column) <= LARGEST_PLAIN):
                return None
    except (TypeError, ValueError):
        return None
    return Controls(np.array(ids, np.int64), np.array(controls, np.float64))


def plain_transforms(raw: list[Any]) -> Transforms | None:
    """Return actors and places of commands that have the index of a transform, None where one of them is unusual."""
    try:
        ids, transforms = _ids_and_bodies(raw)
        if {*map(type, transforms)} != {list}:
            return None
        locations, rotations = zip(*transforms, strict=True)
        for triples in (locations, rotations):
            if {*map(type, triples)} != {list} or {*map(len, triples)} != {3}:
                return None
            for column in zip(*triples, strict=True):
                if {*map(type, column)} != {float} or not hypot(*column) <= LARGEST_PLACE:
                    return None
    except (TypeError, ValueError):
        return None
    return Transforms(ids, tuple((*at, *turned) for at, turned in zip(locations, rotations, strict=True)))


def _ids_and_bodies(raw: list[Any]) -> tuple[tuple[int, ...], tuple[Any, ...]]:
    """Return the actors of commands ``[[index, [actor, body]]]``, and what is to be done with each.

    Raises:
        TypeError, ValueError: one of them has another form, or its actor is no id.
    """
    ids, bodies = zip(*[(actor_id, body) for ((_, (actor_id, body)),) in raw], strict=True)
    if {*map(type, ids)} != {int} or not 0 <= min(ids) <= max(ids) <= LARGEST_ID:
        raise ValueError("not the id of an actor")
    return ids, bodies
