"""A vehicle overtakes and cuts in before a stop sign: NHTSA's "changing lanes, same direction"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.errors import ScenarioError
from basu.routing import ControlKind
from basu.scenarios.actions import ChangeLane, DriveAlong, Hold, InTurn
from basu.scenarios.criteria import Arrives, HeedsStopSigns, InTime, NoCollision
from basu.scenarios.library.lane_change.overtaking import OVERTAKER, OvertakesEgo
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria import Criterion
    from basu.scenarios.parameters import Parameter

CHANGE_M = 12.0
CUTS_IN_MPS = 9.5  # what the overtaker has then at the most, past a shuttle; past a faster ego it stops over the line
LINE_M = 0.5  # its bumper stops so far before the line
RESTS_S = 4.0  # it looks to both sides: longer than an ego right behind it needs to the line


class CutInBeforeStop(OvertakesEgo):
    """A vehicle overtakes the ego, cuts in closely and brakes for the stop sign ahead.

    NHTSA pre-crash scenario 18, vehicles changing lanes, same direction. For a shuttle that keeps to 15 mph this is the
    day's business. An ego that restores its distance stops behind; one that does not hits the other's boot.
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("kind", ("car", "suv", "van", "motorcycle"), "the overtaking vehicle"),
        Number("gap", 1.5, 0.5, 6.0, "m", "between the bumpers when it begins to cut in"),
        Number("passing", 6.0, 4.0, 8.0, "s", "that it takes to get past"),
        Number("brake", 3.0, 2.0, 5.0, "m/s²", "with which it stops at the line"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 50.0, "sun_altitude_angle": 50.0}
    aliases: ClassVar[Sequence[str]] = ("CutIn",)

    @property
    def stops_m(self) -> float:
        """Ahead of the trigger point, where the overtaker's middle comes to stand."""
        signs = [c.s_m for c in self.place.route.controls if c.kind is ControlKind.STOP_SIGN]
        ahead_m = [s_m - self.place.trigger_s_m for s_m in signs if s_m > self.place.trigger_s_m]
        if not ahead_m:
            raise ScenarioError("no stop sign lies ahead on the ego's route; the case belongs before one")
        return ahead_m[0] - LINE_M - self.half_m

    @property
    def cuts_in_m(self) -> float:
        """So that it can just stop at the line."""
        return self.stops_m - CUTS_IN_MPS * CUTS_IN_MPS / (2.0 * 0.8 * self.number("brake")) - CHANGE_M

    def conflict(self) -> Behaviour:
        """It cuts in, stops at the line, and drives on."""
        begin_m, lane = self.place.trigger_s_m, self.lane
        to_line = lane.part(0.0, begin_m + self.stops_m)
        return InTurn(
            self.overtakes(),
            ChangeLane(OVERTAKER, to_line, over_m=CHANGE_M, name=f"{OVERTAKER} cuts in"),
            DriveAlong(OVERTAKER, to_line, CUTS_IN_MPS, brake_mps2=self.number("brake")),
            Hold(OVERTAKER, RESTS_S),
            DriveAlong(OVERTAKER, self._onwards(), CUTS_IN_MPS, at_end="vanish"),
        )

    def criteria(self) -> Sequence[Criterion]:
        """No contact; the ego stops at the line itself, and goes on."""
        return [NoCollision(), HeedsStopSigns(), Arrives(), InTime()]

    def _onwards(self) -> Path:
        """The ego's way, a little short of its end."""
        return self.lane.part(0.0, self.lane.length_m - 2.0)
