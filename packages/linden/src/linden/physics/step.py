"""One frame of physics of many worlds: pushes, vehicles, walkers, props, contacts, in as many substeps as asked."""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kept_part, part, unlocked
from linden.maps.ground import Ground
from linden.physics.columns import BodyTable, empty_rows
from linden.physics.contact.impulses import ACCOUNT, JX, PX, TOUCHED, part_bodies
from linden.physics.contact.pairs import find_pairs, is_fixed
from linden.physics.contact.statics import Statics
from linden.physics.prop import advance_prop
from linden.physics.pushes import apply_forces, apply_impulses, clear_pushes, hold_velocity
from linden.physics.state import SOURCES, VEHICLE, VEHICLE_WORK, WALKER, Body, Rows, Spec, Work
from linden.physics.tumble import is_upset, start_tumbling, tumble
from linden.physics.vehicle.ackermann import drive_to_target
from linden.physics.vehicle.driver import follow_control, let_go
from linden.physics.vehicle.motion import advance_vehicle
from linden.physics.vehicle.rollover import watch_rollover
from linden.physics.vehicle.wheels import turn_wheels
from linden.physics.walker import advance_walker

if TYPE_CHECKING:
    from linden.physics.bodies import Bodies

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

GRAVITY_MPS2 = 9.81

CONTACT = np.dtype(
    [
        ("world", "i4"),
        ("a", "i4"),  # slot
        ("b", "i4"),  # slot, greater than a; -1: a static
        ("static_id", "i8"),  # as given to Statics; -1 where b is a slot
        ("tag", "u1"),  # of the static; 0 where b is a slot
        ("impulse", "f8", 3),  # N·s on a, over the whole call; b gets the opposite
        ("point", "f8", 3),  # m, where they last touched
    ]
)
Contacts = NDArray[Any]
"""Array of CONTACT ordered by (world, a, b, static's number), at most one row a pair."""

_Advance = Callable[[Rows, I32, Rows, Rows, I32, I32, Ground, Statics, float, int, float], F64]


@part
def _advance_bodies(
    rows: Rows,
    spec_of: I32,
    specs: Rows,
    work: Work,
    count: int,
    ground: Ground,
    gravity_mps2: float,
    dt_s: float,
    left: int,
) -> None:
    """Advance every body of a world by one substep, in the order of the slots."""
    for i in range(count):
        v = rows[i]
        if not v.alive:
            continue
        if is_fixed(v):
            for axis in range(3):
                v.velocity[axis] = 0.0
                v.angular_velocity[axis] = 0.0
            continue
        apply_forces(v, work, dt_s)
        if v.kind == VEHICLE and not v.tumbling and is_upset(v, specs[spec_of[i]]):
            start_tumbling(v)
        if v.kind == VEHICLE and not v.tumbling:
            advance_vehicle(v, specs[spec_of[i]], work, ground, gravity_mps2, dt_s, left)
            turn_wheels(v, specs[spec_of[i]], dt_s)
            continue
        if v.constant_velocity_on:
            hold_velocity(v)
        if v.tumbling:
            tumble(v, specs[spec_of[i]], work, ground, gravity_mps2, dt_s)
            continue
        if v.kind == WALKER:
            advance_walker(v, ground, gravity_mps2, dt_s)
        else:
            advance_prop(v, ground, gravity_mps2, dt_s)


@kept_part(SOURCES)
def heed_driver(v: Body, spec: Spec, dt_s: float) -> None:
    """Bring what a vehicle's driver does up to date for a frame."""
    let_go(v)
    if is_fixed(v):
        return
    if v.ackermann_on:
        drive_to_target(v, spec, dt_s)
    follow_control(v, dt_s)


@part
def _keep_velocity(v: Body) -> None:
    """Write a body's velocity where :func:`_write_acceleration` finds it."""
    for axis in range(3):
        v.acceleration[axis] = v.velocity[axis]


@part
def _write_acceleration(v: Body, dt_s: float) -> None:
    """Write the acceleration since :func:`_keep_velocity`."""
    for axis in range(3):
        v.acceleration[axis] = (v.velocity[axis] - v.acceleration[axis]) / dt_s


@part
def begin_frame(rows: Rows, spec_of: I32, specs: Rows, work: Work, count: int, dt_s: float) -> None:
    """Apply impulses and let the drivers act, before the pairs of a world are sought."""
    for i in range(count):
        v = rows[i]
        _keep_velocity(v)
        if v.alive and not is_fixed(v):
            apply_impulses(v, work)
        if v.kind == VEHICLE:
            heed_driver(v, specs[spec_of[i]], dt_s)


@part
def run_frame(
    rows: Rows,
    spec_of: I32,
    specs: Rows,
    work: Work,
    count: int,
    pairs: I32,
    account: F64,
    ground: Ground,
    statics: Statics,
    dt_s: float,
    substeps: int,
    gravity_mps2: float,
) -> None:
    """Advance the bodies of a world by all substeps; ``account`` (P, ACCOUNT) is zero and gets what touched."""
    for n in range(substeps):
        left = substeps - 1 - n
        _advance_bodies(rows, spec_of, specs, work, count, ground, gravity_mps2, dt_s / substeps, left)
        if len(pairs) > 0:
            part_bodies(rows, pairs, statics, work, account)
    for i in range(count):
        v = rows[i]
        _write_acceleration(v, dt_s)
        clear_pushes(v)
        if v.tumbling or v.rollover_stage > 0:
            watch_rollover(v, dt_s)


@part
def _report(world: int, pairs: I32, account: F64, rows: F64, found: int) -> tuple[F64, int]:
    """Append the pairs of a world that touched: world, first, second, impulse, point; return rows and number."""
    for n in range(len(pairs)):
        pressed = account[n, JX] != 0.0 or account[n, JX + 1] != 0.0
        if account[n, TOUCHED] != 0.0 and pressed:
            if found == len(rows):
                longer = np.empty((2 * found + 8, 9))
                longer[:found] = rows
                rows = longer
            rows[found, 0], rows[found, 1], rows[found, 2] = world, pairs[n, 0], pairs[n, 1]
            for axis in range(3):
                rows[found, 3 + axis] = account[n, JX + axis]
                rows[found, 6 + axis] = account[n, PX + axis]
            found += 1
    return rows, found


def _build(sources: int) -> _Advance:
    """Return the compiled frame; ``sources`` becomes part of the name it is cached under."""

    def advance(
        state: Rows,
        spec_of: I32,
        specs: Rows,
        work: Rows,
        counts: I32,
        worlds: I32,
        ground: Ground,
        statics: Statics,
        dt_s: float,
        substeps: int,
        gravity_mps2: float,
    ) -> F64:
        _fingerprint = sources
        touched: F64 = np.empty((0, 9))
        found = 0
        for world in worlds:
            rows, which, count = state[world], spec_of[world], counts[world]
            begin_frame(rows, which, specs, work[0], count, dt_s)
            pairs = find_pairs(rows, count, statics, dt_s)
            account = np.zeros((len(pairs), ACCOUNT))
            run_frame(rows, which, specs, work[0], count, pairs, account, ground, statics, dt_s, substeps, gravity_mps2)
            touched, found = _report(world, pairs, account, touched, found)
        return touched[:found]

    return unlocked(advance)  # a frame of many bodies may take seconds, and a signal is to end the server


_advance = _build(SOURCES)


def advance(
    bodies: "Bodies",
    ground: Ground,
    statics: Statics,
    dt_s: float,
    substeps: int = 1,
    *,
    gravity_mps2: float = GRAVITY_MPS2,
) -> Contacts:
    """Advance all bodies of a world by ``dt_s`` in ``substeps`` equal steps and return what touched.

    Impulses act at the start, forces throughout; both are forgotten afterwards. Accelerations are those of the whole
    ``dt_s``. Raises ValueError where ``dt_s`` or ``substeps`` is not positive.
    """
    return advance_worlds(bodies.table, bodies.worlds, ground, statics, dt_s, substeps, gravity_mps2=gravity_mps2)


def advance_worlds(
    table: BodyTable,
    worlds: I32,
    ground: Ground,
    statics: Statics,
    dt_s: float,
    substeps: int = 1,
    *,
    gravity_mps2: float = GRAVITY_MPS2,
) -> Contacts:
    """Advance the bodies of ``worlds`` (K,) as :func:`advance` does; contacts come in the order of ``worlds``."""
    if not (0.0 < dt_s < np.inf and substeps >= 1):
        raise ValueError(f"a step needs a positive duration and at least one substep, not {dt_s} s in {substeps}")
    columns = table.state, table.spec_of, table.specs, empty_rows(1, VEHICLE_WORK), table.counts, worlds
    rows = _advance(*columns, ground, statics, float(dt_s), int(substeps), float(gravity_mps2))
    return _contacts(rows, statics) if len(rows) else _NO_CONTACTS


def contacts_of(accounts: Iterable[tuple[int, I32, F64]], statics: Statics) -> Contacts:
    """Return the contacts of worlds by their numbers, pairs (P, 2) and accounts (P, ACCOUNT)."""
    touched: F64 = np.empty((0, 9))
    found = 0
    for world, pairs, account in accounts:
        touched, found = _report(world, pairs, account, touched, found)
    return _contacts(touched[:found], statics)


def step(
    bodies: "Bodies", ground: Ground, statics: Statics, dt_s: float, *, gravity_mps2: float = GRAVITY_MPS2
) -> Contacts:
    """Advance all bodies by one step of ``dt_s``; see :func:`advance`."""
    return advance(bodies, ground, statics, dt_s, 1, gravity_mps2=gravity_mps2)


def _contacts(rows: F64, statics: Statics) -> Contacts:
    """Return rows of (world, first, second, impulse, point) as CONTACT."""
    contacts = np.zeros(len(rows), CONTACT)
    other = rows[:, 2].astype(np.int64)
    standing = other < 0
    contacts["world"], contacts["a"] = rows[:, 0], rows[:, 1]
    contacts["b"] = np.where(standing, -1, other)
    contacts["static_id"] = -1
    contacts["static_id"][standing] = statics.id[-1 - other[standing]]
    contacts["tag"][standing] = statics.tag[-1 - other[standing]]
    contacts["impulse"], contacts["point"] = rows[:, 3:6], rows[:, 6:9]
    return contacts


_NO_CONTACTS: Contacts = cast("Contacts", np.zeros(0, CONTACT))
_NO_CONTACTS.flags.writeable = False
