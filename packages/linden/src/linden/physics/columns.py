"""`BodyTable`: bodies of many worlds and the specifications of their vehicles. `Columns`: the bodies of one world."""

import math
from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar, overload
from weakref import WeakSet

import numba
import numpy as np
from numpy.typing import NDArray

from linden.physics.state import BODY, VEHICLE_SPEC, Rows
from linden.protocol.values.control import Undercarriage, VehiclePhysicsControl
from linden.protocol.values.space import Vector3D

Scalar = TypeVar("Scalar", bound=np.generic)


class Column(Generic[Scalar]):
    """A column of the state by its name. Ask for it anew each step: growing replaces the arrays."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    @overload
    def __get__(self, bodies: None, owner: type) -> "Column[Scalar]": ...

    @overload
    def __get__(self, bodies: "Columns", owner: type) -> NDArray[Scalar]: ...

    def __get__(self, bodies: "Columns | None", owner: type) -> Any:
        """Return the array itself."""
        return self if bodies is None else bodies.state[self._name]


def empty_rows(count: int | tuple[int, int], layout: np.dtype[np.void]) -> Rows:
    """Return zeroed rows; with the compiler off (for coverage) their fields are attributes, as kernels spell them."""
    rows = np.zeros(count, layout)
    return rows.view(np.recarray) if numba.config.DISABLE_JIT else rows  # type: ignore[attr-defined] # set by numba at import


def twice(rows: Rows) -> Rows:
    """Return the rows with as many zeroed ones behind them."""
    larger = empty_rows(2 * len(rows), rows.dtype)
    larger[: len(rows)] = rows
    return larger


def finite(value: float, low: float = -math.inf, high: float = math.inf) -> float:
    """Return ``value`` within its limits, 0 where it is nan: a client may send anything and the physics goes on."""
    return 0.0 if math.isnan(value) else min(max(float(value), low), high)


class VehicleDesign(NamedTuple):
    """What a specification is made from; vehicles with equal designs share one."""

    control: VehiclePhysicsControl
    offsets_m: tuple[Vector3D, ...]
    undercarriage: Undercarriage
    centre_of_mass_m: Vector3D


class BodyTable:
    """The bodies of many worlds as rows (world, slot), and the specifications that their vehicles share.

    Attributes:
        state: (W, S) of BODY; slots grow by use, in all worlds alike.
        counts: (W,) slots below this have been given out in a world; kernels look no further.
        spec_of: (W, S) row of each vehicle in ``specs``; 0 for other bodies.
        specs: of VEHICLE_SPEC, one row for each design in use; row 0 is empty.
        kept: arrays of other rows of ``specs`` that are in use.
    """

    def __init__(self, worlds: int = 1, slots: int = 4) -> None:
        self.state = empty_rows((worlds, slots), BODY)
        self.counts = np.zeros(worlds, np.int32)
        self.spec_of = np.zeros((worlds, slots), np.int32)
        self.specs = empty_rows(4, VEHICLE_SPEC)
        self._designs: list[VehicleDesign | None] = [None]
        self.kept: list[NDArray[np.int32]] = []
        self._row_of: dict[VehicleDesign, int] = {}
        self._views: WeakSet[Columns] = WeakSet()

    def view(self, columns: "Columns") -> None:
        """Let an object read the rows of its world, and again each time that the table grows."""
        self._views.add(columns)
        self._show(columns)

    def _show(self, columns: "Columns") -> None:
        columns.state, columns.spec_of = self.state[columns.world], self.spec_of[columns.world]

    def grow(self) -> None:
        """Double the slots of all worlds."""
        before = self.state, self.spec_of
        worlds, slots = before[0].shape
        self.state, self.spec_of = empty_rows((worlds, 2 * slots), BODY), np.zeros((worlds, 2 * slots), np.int32)
        self.state[:, :slots], self.spec_of[:, :slots] = before
        for columns in self._views:
            self._show(columns)

    def design(self, row: int) -> VehicleDesign:
        """Return what a row of ``specs`` was made from; not of row 0."""
        design = self._designs[row]
        assert design is not None
        return design

    def row_of(self, design: VehicleDesign, specification: Callable[[], Rows]) -> int:
        """Return the row of a design in ``specs``; ``specification`` makes it where no vehicle has this design."""
        row = self._row_of.get(design)
        if row is None:
            made = specification()
            row = self._free_row(design)
            self.specs[row] = made
            self._row_of[design] = row
        return row

    def _free_row(self, design: VehicleDesign) -> int:
        """Return a row for a new design: behind the others, or in a full table that of a design without vehicles."""
        if len(self._designs) == len(self.specs):
            in_use = {row for rows in (self.spec_of, *self.kept) for row in np.unique(rows).tolist()}
            for row, known in enumerate(self._designs):
                if known is not None and row not in in_use:
                    del self._row_of[known]
                    self._designs[row] = design
                    return row
            self.specs = twice(self.specs)
        self._designs.append(design)
        return len(self._designs) - 1


class Columns:
    """The rows of one world of a table, and its public columns; units and shapes stand in ``linden.physics.state``."""

    alive: Column[np.bool_] = Column()
    kind: Column[np.uint8] = Column()
    simulate: Column[np.bool_] = Column()
    gravity: Column[np.bool_] = Column()
    collides: Column[np.bool_] = Column()
    position: Column[np.float64] = Column()
    rotation: Column[np.float64] = Column()
    velocity: Column[np.float64] = Column()
    angular_velocity: Column[np.float64] = Column()
    acceleration: Column[np.float64] = Column()
    box_centre: Column[np.float64] = Column()
    half_extent: Column[np.float64] = Column()
    mass_kg: Column[np.float64] = Column()
    throttle: Column[np.float64] = Column()
    steer: Column[np.float64] = Column()
    brake: Column[np.float64] = Column()
    hand_brake: Column[np.bool_] = Column()
    reverse: Column[np.bool_] = Column()
    manual_gear_shift: Column[np.bool_] = Column()
    gear_command: Column[np.int32] = Column()
    gear: Column[np.int32] = Column()
    engine_rpm: Column[np.float64] = Column()
    wheel_omega: Column[np.float64] = Column()
    wheel_steer: Column[np.float64] = Column()
    wheel_turned: Column[np.float64] = Column()
    wheel_long_slip: Column[np.float64] = Column()
    wheel_lat_slip: Column[np.float64] = Column()
    wheel_load: Column[np.float64] = Column()
    wheel_long_force: Column[np.float64] = Column()
    wheel_lat_force: Column[np.float64] = Column()
    wheel_torque: Column[np.float64] = Column()
    road_friction: Column[np.float64] = Column()
    friction_here: Column[np.float64] = Column()
    failure: Column[np.uint8] = Column()
    tumbling: Column[np.bool_] = Column()
    walker_direction: Column[np.float64] = Column()
    walker_speed: Column[np.float64] = Column()
    jump: Column[np.bool_] = Column()

    state: Rows
    """Rows of this world, (S,) of BODY; another array after the table has grown."""
    spec_of: NDArray[np.int32]

    def __init__(self, table: BodyTable | None = None, world: int = 0) -> None:
        """View a world of ``table``; without one, that of a table of its own."""
        self.table = BodyTable() if table is None else table
        self.world = world
        self.worlds = np.array([world], np.int32)
        self.table.view(self)

    @property
    def count(self) -> int:
        """Slots below this have been given out."""
        return int(self.table.counts[self.world])

    def spec(self, slot: int | NDArray[np.integer]) -> Rows:
        """Return the shared VEHICLE_SPEC of the vehicle in a slot, or those of slots; it is empty for other bodies."""
        return self.table.specs[self.spec_of[slot]]

    def design(self, slot: int) -> VehicleDesign:
        """Return what the specification of the vehicle in a slot was made from."""
        return self.table.design(self.spec_of[slot])

    def wake(self, slot: int) -> None:
        """Let the next step look at the body again, were it at rest."""
        self.state["resting"][slot] = False
