"""The columns of all bodies as attributes, typed, whatever arrays they are at the moment."""

import math
from typing import Any, Generic, TypeVar, overload

import numba
import numpy as np
from numpy.typing import NDArray

from linden.physics.state import BODY, VEHICLE_SPEC, VEHICLE_WORK, Rows

Scalar = TypeVar("Scalar", bound=np.generic)

_FIRST_CAPACITY = 64


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


def empty_rows(count: int, layout: np.dtype[np.void]) -> Rows:
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


class Columns:
    """The state and its public columns; units and shapes stand in ``linden.physics.state``."""

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

    def __init__(self) -> None:
        self.state = empty_rows(_FIRST_CAPACITY, BODY)
        self.specs = empty_rows(_FIRST_CAPACITY, VEHICLE_SPEC)
        self.work = empty_rows(1, VEHICLE_WORK)
        """Scratch of the kernels; nothing in it outlives a step."""
        self.count = 0
        """Slots below this have been given out; kernels look no further."""

    def wake(self, slot: int) -> None:
        """Let the next step look at the body again, were it at rest."""
        self.state["resting"][slot] = False
