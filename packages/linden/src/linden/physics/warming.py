"""Compile at a moment of one's own choosing: when installing, not when the first vehicle waits.

The frame of physics takes as long to compile as all else that a first tick needs. So parts of it can be compiled in
two other processes; :func:`warm_up` then finds them in the cache.
"""

from typing import Any

import numba
import numpy as np

from linden.compiled import COMPILER_IS_OFF
from linden.maps.ground import Ground, surface_under
from linden.physics.bodies import Bodies
from linden.physics.columns import empty_rows
from linden.physics.contact.impulses import ACCOUNT, part_bodies
from linden.physics.contact.pairs import find_pairs
from linden.physics.contact.statics import Statics
from linden.physics.pushes import apply_forces, apply_impulses
from linden.physics.state import VEHICLE_WORK
from linden.physics.step import advance, heed_driver
from linden.physics.tumble import tumble
from linden.physics.vehicle.motion import advance_vehicle


def warm_up() -> None:
    """Compile, or load from the cache, all that a server calls: the ground and a frame of physics."""
    corners = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    ground = Ground.from_triangles(corners, [[0, 1, 2]])
    surface_under(ground, 0.1, 0.1, 0.0)
    ground.surfaces_under([[0.1, 0.1, 0.0]])
    bodies = Bodies()
    advance(bodies, ground, Statics.none(), 0.01)
    bodies.set_controls(np.empty(0, np.int32), np.empty((0, 7)))


def compile_driving() -> None:
    """Compile what moves a vehicle on its wheels, and what pushes it."""
    row, spec, work, _ = _types()
    real, whole = numba.float64, numba.int64
    _compile(advance_vehicle, row, spec, work, _type_of(Ground.flat()), real, real, whole)
    _compile(heed_driver, row, spec, real)
    _compile(apply_impulses, row, work)
    _compile(apply_forces, row, work, real)


def compile_contacts() -> None:
    """Compile what finds and parts bodies that overlap, and what moves a vehicle off its wheels."""
    row, spec, work, rows = _types()
    real, whole = numba.float64, numba.int64
    statics, pairs, account = (_type_of(each) for each in (Statics.none(), _PAIRS, _ACCOUNT))
    _compile(find_pairs, rows, whole, statics, real)
    _compile(part_bodies, rows, pairs, statics, work, account)
    _compile(tumble, row, spec, work, _type_of(Ground.flat()), real, real)


_PAIRS, _ACCOUNT = np.empty((0, 2), np.int32), np.empty((0, ACCOUNT))


def _type_of(value: object) -> Any:  # noqa: ANN401 - a type of numba's
    return numba.typeof(value)  # type: ignore[no-untyped-call] # numba has no hints for it


def _types() -> tuple[Any, Any, Any, Any]:
    """Return numba's types of a body, of its constants, of the scratch, and of the array of bodies."""
    bodies = Bodies()
    columns = [_type_of(column) for column in (bodies.state, bodies.table.specs, empty_rows(1, VEHICLE_WORK))]
    return (*(column.dtype for column in columns), columns[0])


def _compile(function: Any, *types: Any) -> None:  # noqa: ANN401 - numba's objects have no types
    """Compile a kernel for arguments of these types, or load it from the cache; it is not run."""
    if not COMPILER_IS_OFF:
        function.compile(types)
