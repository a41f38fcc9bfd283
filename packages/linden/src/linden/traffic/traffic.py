"""Traffic lights and signs of an episode: states of the lights, vehicles under them, colours that signs show."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linden.errors import Refusal
from linden.protocol.values.enums import TrafficLightState
from linden.structured import StructuredArray
from linden.traffic import cycle
from linden.traffic.cycle import restored
from linden.traffic.signal_actors import NO_LIGHT, Signals
from linden.traffic.signs import U8, BodyColumns, SignWatch
from linden.traffic.trigger_volumes import F64, I32, owners_over

TIMED = (TrafficLightState.RED, TrafficLightState.YELLOW, TrafficLightState.GREEN)


class Traffic:
    """Lights and signs of one map. Lights are named by their number: their place among the lights.

    Attributes:
        actors: every light, then every sign, each in the order of the map.
        lights: index in ``actors`` of each light: 0, 1, 2 and so on.
        state: how the lights stand; replaced whole.
    """

    def __init__(self, signals: Signals) -> None:
        """Begin the cycles of a map's lights."""
        self.actors, self._plan, self._grid, rules = signals
        self._signs = SignWatch(rules)
        self.lights = range(sum(actor.light != NO_LIGHT for actor in self.actors))
        self.state = cycle.initial(self._plan)
        self._shown: cycle.CycleState | None = None
        self._compile()

    def step(self, dt_s: float) -> None:
        """Let ``dt_s`` pass."""
        if self.lights:
            self.state = cycle.step(self._plan, self.state, dt_s)

    def over(self, position_m: F64, rotation_rad: F64, box_centre_m: F64, half_extent_m: F64, slots: I32) -> I32:
        """Return for each of ``slots`` (V,) the light with the trigger volume that the body touches, or -1.

        The columns are those of the bodies, (N, 3); ``triggers.owners_over`` says more.
        """
        return owners_over(self._grid, position_m, rotation_rad, box_centre_m, half_extent_m, slots)

    def at_signs(
        self, position_m: F64, rotation_rad: F64, box_centre_m: F64, half_extent_m: F64, slots: I32, actor_ids: I32,
        now_s: float,
    ) -> U8:  # fmt: skip
        """Return the colour (V,) that stop and yield signs show to vehicles under them; green to all others.

        The columns are those of :meth:`over`; ``actor_ids`` (V,) are the actors in the slots, ``now_s`` is the time.
        """
        bodies = BodyColumns(position_m, rotation_rad, box_centre_m, half_extent_m)
        return self._signs.told(bodies, slots, actor_ids, now_s)

    def _compile(self) -> None:
        """Compile the kernels for columns such as the bodies have (parts of records), before the first step."""
        column, empty = np.zeros((2, 4))[:, :3], np.zeros(0, np.int32)
        self.over(column, column, column, column, empty)
        self.at_signs(column, column, column, column, empty, empty, 0.0)

    def group(self, light: int) -> tuple[int, ...]:
        """Return the lights that take turns with this one, itself among them."""
        groups = self._plan.group_of_light
        return tuple(map(int, np.flatnonzero(groups == groups[light])))

    def pole_index(self, light: int) -> int:
        """Return the place of a light within its group."""
        return self.group(light).index(light)

    def set_colour(self, light: int, colour: TrafficLightState) -> None:
        """Give one light a colour; it keeps it until its turn changes, or as long as its group is frozen."""
        self.state = cycle.with_colour(self.state, light, colour)

    def set_time(self, light: int, colour: TrafficLightState, time_s: float) -> None:
        """Set for how long red, yellow or green lasts for this light and those of the same controller.

        Raises:
            Refusal: not a time that can pass.
        """
        if colour not in TIMED:
            raise Refusal(f"only red, yellow and green last for a time, not {TrafficLightState(colour).name.lower()}")
        if not (math.isfinite(time_s) and time_s >= 0.0):
            raise Refusal(f"a light cannot be {colour.name.lower()} for {time_s} s: expected a finite time from 0 on")
        self.state = cycle.with_time(self._plan, self.state, light, colour, time_s)

    def freeze(self, light: int, *, frozen: bool) -> None:
        """Stop or restart time for the group of a light."""
        self.state = cycle.with_frozen(self.state, self._group_of(light), frozen=frozen)

    def freeze_all(self, *, frozen: bool) -> None:
        """Stop or restart time for every light."""
        self.state = cycle.with_frozen(self.state, self._groups(), frozen=frozen)

    def reset_group(self, light: int) -> None:
        """Begin the cycle of a light's group anew; times that were set stay."""
        self.state = cycle.reset(self._plan, self.state, self._group_of(light))

    def reset_all(self) -> None:
        """Begin every cycle anew."""
        self.state = cycle.reset(self._plan, self.state, self._groups())

    def write(self, rows: StructuredArray) -> None:
        """Write how the lights stand into their rows of the snapshot: (L,) of TRAFFIC_LIGHT_ROW, in the lights' order.

        The rows keep what they hold from call to call: what has not changed since the last one is not written again.
        Sign ids and pole indices never change and are written by the caller.
        """
        state, shown, controller = self.state, self._shown, self._plan.controller_of_light
        rows["elapsed_time"] = cycle.elapsed_s(self._plan, state)
        if shown is None or state.times_s is not shown.times_s:
            rows["green_time"] = state.times_s[controller, TrafficLightState.GREEN]
            rows["yellow_time"] = state.times_s[controller, TrafficLightState.YELLOW]
            rows["red_time"] = state.times_s[controller, TrafficLightState.RED]
        if shown is None or state.pace is not shown.pace:
            rows["frozen"] = cycle.is_frozen(self._plan, state)
        if shown is None or state.colour is not shown.colour:
            rows["state"] = state.colour
        self._shown = state

    def restore(self, lights: NDArray[np.integer[Any]], colour: U8, elapsed_s: F64, frozen: NDArray[np.bool_]) -> None:
        """Let lights stand as a recording has them; see ``restored``."""
        self.state = restored(self._plan, self.state, lights, colour, elapsed_s, frozen)

    def _group_of(self, light: int) -> I32:
        return self._plan.group_of_light[light : light + 1]

    def _groups(self) -> I32:
        return np.arange(len(self._plan.first_controller) - 1, dtype=np.int32)
