"""A vehicle turns right into the ego's lane: NHTSA's "right turn into path"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import DriveAlong, InTurn, ReachAtEgosArrival
from basu.scenarios.library.crossing_paths.from_the_side import (
    NARROWLY,
    OTHER,
    SETTLED_S,
    AcrossTheWay,
    green_for_ego,
    has_light,
)
from basu.scenarios.library.road_users import SETS_OFF_MPS2
from basu.scenarios.parameters import Choice, Number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.parameters import Parameter
    from basu.scenarios.paths.crossings import Side

DAWDLES_M = 18.0  # behind the place where the ways meet, before it drives as others do
GETS_GOING_M = 12.0
STREET_MPS = 9.0  # 20 mph


class RightTurnIntoPath(AcrossTheWay):
    """A vehicle turns right out of a side street, just in front of the ego, and takes its time.

    NHTSA pre-crash scenario 31, turning at a non-signalised junction. The other comes out of its stop street shortly
    before the ego is there and needs a while to get going: an ego that does not slow down hits its boot. Where the
    junction has lights, the ego's is green, and the other turns right on red: scenario 28.
    """

    turn = "right"
    comes_before = True
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("kind", ("car", "van", "truck", "motorcycle"), "the turning vehicle"),
        Number("speed", 4.0, 2.5, 6.0, "m/s", "of the other in its turn"),
        Number("pace", 3.0, 1.5, 5.0, "m/s", "of the other for the first metres in the ego's lane"),
        Number("lead", 1.6, 0.8, 4.0, "s", "by which the other is in the lane before the ego"),
        Number("notice", 5.5, 3.5, 7.0, "s", "before the ego's arrival, when the other sets off"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 90.0, "wetness": 40.0, "sun_altitude_angle": 30.0}

    @property
    def side(self) -> Side:
        """Right turns come from there."""
        return "right"

    @property
    def lateness_s(self) -> float:
        """It gets there before the ego."""
        return -self.number("lead")

    def setup(self) -> Behaviour | None:
        """Green for the ego where the junction has lights."""
        return green_for_ego(self.place) if has_light(self.place) else None

    def conflict(self) -> Behaviour:
        """It turns in, dawdles, and drives on."""
        speed_mps, pace_mps, way = self.number("speed"), self.number("pace"), self.crossing
        slow_m = way.meet_s_m + DAWDLES_M
        low, high = NARROWLY
        return InTurn(
            ReachAtEgosArrival(
                OTHER,
                way.path,
                way.meet_s_m,
                way.ego_s_m,
                self.lateness_s,
                low_mps=low * speed_mps,
                high_mps=high * speed_mps,
                settled_s=SETTLED_S,
                accelerate_mps2=SETS_OFF_MPS2,
            ),
            DriveAlong(
                OTHER,
                way.path,
                ((way.meet_s_m, pace_mps), (slow_m, pace_mps), (slow_m + GETS_GOING_M, STREET_MPS)),
                at_end="vanish",
            ),
        )
