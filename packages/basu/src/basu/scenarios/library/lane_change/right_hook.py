"""A vehicle overtakes and turns right across the ego's nose: NHTSA's "turning, same direction"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import DriveAlong, InTurn
from basu.scenarios.library.lane_change.overtaking import OVERTAKER, OvertakesEgo
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path, along_lane, lanes_apart_m, next_junction

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.parameters import Parameter

CHANGE_M = 12.0
SLOWS_M = 14.0  # in the ego's lane before the junction begins
LEAVES_M = 40.0
EASES_M = 8.0  # behind the junction's beginning, before it speeds up again


class RightHook(OvertakesEgo):
    """A vehicle overtakes the ego just before a side street, cuts in, brakes and turns right into it.

    NHTSA pre-crash scenario 16, vehicles turning, same direction. The ego goes straight on. The other slows down to the
    speed of its turn right before the ego's nose.
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("kind", ("car", "suv", "van"), "the overtaking vehicle"),
        Number("gap", 2.0, 0.5, 6.0, "m", "between the bumpers when it begins to cut in"),
        Number("passing", 6.0, 4.0, 8.0, "s", "that it takes to get past"),
        Number("turns_at", 3.0, 1.5, 5.0, "m/s", "its speed in the turn"),
        Number("brake", 3.5, 2.0, 5.0, "m/s²", "with which it slows down for that"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 100.0, "fog_density": 20.0, "sun_altitude_angle": 20.0}

    @property
    def cuts_in_m(self) -> float:
        """So that it is in the lane before the junction and can slow down for its turn there."""
        return next_junction(self.place).from_m - SLOWS_M - CHANGE_M

    def conflict(self) -> Behaviour:
        """It gets past, cuts in and turns."""
        turn_m = self.place.trigger_s_m + next_junction(self.place).from_m
        begin_m, apart_m = self.place.trigger_s_m + self.cuts_in_m, lanes_apart_m(self.place, self.cuts_in_m)
        start = self.place.at(-self.place.trigger_s_m)
        street: Path = along_lane(self.place.carla_map, start, turn_m + LEAVES_M, ("right",))
        path = street.swerved(begin_m, CHANGE_M, -apart_m, 0.0)
        turns_mps = self.number("turns_at")
        return InTurn(
            self.overtakes(),
            DriveAlong(
                OVERTAKER,
                path,
                ((turn_m + EASES_M, turns_mps), (turn_m + EASES_M + 10.0, 2.0 * turns_mps)),
                brake_mps2=self.number("brake"),
                at_end="vanish",
            ),
        )
