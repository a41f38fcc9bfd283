"""What a script for many actors sends in every tick, a control or a transform for each, read column by column.

Whatever is unusual in it is left to the decoders of :mod:`linden.wire.commands`, which take it command by command and
say in a sentence what does not fit.
"""

from math import hypot
from typing import Any, NamedTuple

from linden.values.vehicles import VehicleControl

LARGEST_PLACE = 1e9
"""Metres and degrees; a transform with more is unusual and is read by itself."""
WORTH_COLUMNS = 8
"""Commands of one kind in a row from which this is quicker than one after the other."""
LARGEST_ID = 2**32 - 1
LARGEST_PLAIN = 2**31 - 1
"""Pedals, wheel and gear are far below."""

_TYPES = tuple(VehicleControl.__annotations__[name] for name in VehicleControl._fields)


class Controls(NamedTuple):
    """Controls of vehicles in the order in which they came, none of them unusual."""

    actor_ids: tuple[int, ...]
    controls: tuple[Any, ...]  # for each a sequence in the order of VehicleControl's fields


def plain_controls(raw: list[Any]) -> Controls | None:
    """Return actors and controls of commands that have the index of a control, None where one of them is unusual.

    Plain are those of which every field has the very type it is sent with, none missing, and no number is too large:
    none in a column is larger than the root of the sum of their squares, which is NaN where one of them is.
    """
    try:
        ids, controls = zip(*[(actor_id, control) for ((_, (actor_id, control)),) in raw], strict=True)
        if {*map(type, ids)} != {int} or not 0 <= min(ids) <= max(ids) <= LARGEST_ID:
            return None
        if {*map(type, controls)} != {list} or {*map(len, controls)} != {len(_TYPES)}:
            return None
        for column, kind in zip(zip(*controls, strict=True), _TYPES, strict=True):
            if {*map(type, column)} != {kind} or (kind is not bool and not hypot(*column) <= LARGEST_PLAIN):
                return None
    except (TypeError, ValueError):
        return None
    return Controls(ids, controls)


class Transforms(NamedTuple):
    """Transforms of actors in the order in which they came, none of them unusual."""

    actor_ids: tuple[int, ...]
    transforms: tuple[Any, ...]  # for each x, y, z in m and pitch, yaw, roll in degrees


def plain_transforms(raw: list[Any]) -> Transforms | None:
    """Return actors and places of commands that have the index of a transform, None where one of them is unusual."""
    try:
        ids, transforms = zip(*[(actor_id, transform) for ((_, (actor_id, transform)),) in raw], strict=True)
        if {*map(type, ids)} != {int} or not 0 <= min(ids) <= max(ids) <= LARGEST_ID:
            return None
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
