"""A vehicle stands across the ego's way in a junction: NHTSA's "straight crossing paths", with the other at rest."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import DriveAlong, InTurn, ReachAtEgosArrival, Wait
from basu.scenarios.library.crossing_paths.from_the_side import (
    LEAVES_M,
    NARROWLY,
    OTHER,
    AcrossTheWay,
    green_for_ego,
    has_light,
)
from basu.scenarios.library.road_users import SETS_OFF_MPS2
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.triggers import Slower
from basu.thresholds import STANDING_TRAFFIC_MPS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.parameters import Parameter

STOPS_M = 6.0  # it brakes over the last of its way


class CarAcrossJunction(AcrossTheWay):
    """A vehicle from the side gets stuck in the junction, across the ego's way, and drives on after a while.

    NHTSA pre-crash scenario 30, straight crossing paths. It stands there some seconds before the ego arrives. The
    ego's light is green, or its street has the right of way; neither is a reason to drive into another vehicle.
    """

    comes_before = True
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("side", ("left", "right"), "from which the other comes"),
        Choice("kind", ("van", "car", "truck", "suv"), "the other vehicle"),
        Number("speed", 6.0, 4.0, 9.0, "m/s", "of the other before it stops"),
        Number("notice", 7.5, 6.0, 10.0, "s", "before the ego's arrival, when the other sets off"),
        Number("lead", 3.5, 2.5, 5.0, "s", "before the ego, when the other gets into its way"),
        Number("stands", 4.0, 1.0, 8.0, "s", "for which the other stands after the ego has come to rest"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 60.0, "precipitation": 40.0, "precipitation_deposits": 50.0}
    aliases: ClassVar[Sequence[str]] = ("BlockedIntersection",)

    def setup(self) -> Behaviour | None:
        """Where there are lights, the ego's is green."""
        return green_for_ego(self.place) if has_light(self.place) else None

    @property
    def lateness_s(self) -> float:
        """It gets there before the ego."""
        return -self.number("lead")

    def conflict(self) -> Behaviour:
        """It stops in the ego's way until the ego has stopped for it, and a while longer."""
        way, speed_mps = self.crossing, self.number("speed")
        low, high = NARROWLY
        return InTurn(
            ReachAtEgosArrival(
                OTHER,
                way.path,
                way.meet_s_m - STOPS_M,
                way.ego_s_m,
                self.lateness_s,
                low_mps=low * speed_mps,
                high_mps=high * speed_mps,
                accelerate_mps2=SETS_OFF_MPS2,
            ),
            DriveAlong(OTHER, way.path, speed_mps, to_m=way.meet_s_m),
            Slower(STANDING_TRAFFIC_MPS),
            Wait(self.number("stands")),
            DriveAlong(OTHER, way.path, speed_mps, to_m=way.meet_s_m + LEAVES_M - 2.0, at_end="vanish"),
        )
