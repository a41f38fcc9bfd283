"""What a traffic script sends in every tick, a control for each vehicle, read column by column.

Whatever is unusual in it is left to the decoders of :mod:`linden.wire.commands`, which take it command by command and
say in a sentence what does not fit.
"""

from math import hypot
from typing import Any, NamedTuple

from linden.values.vehicles import VehicleControl

WORTH_COLUMNS = 8
"""Controls in a row from which this is quicker than one after the other."""
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
