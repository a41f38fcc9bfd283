"""Parked cars narrow the street for an oncoming vehicle: NHTSA's "opposite direction, making a maneuver"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.library.opposite_direction.out_of_lane import OutOfLane
from basu.scenarios.library.road_users import BLUEPRINTS, HALF_LENGTH_M
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import oncoming
from basu.scenarios.stage import ActorSpec

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.scenarios.parameters import Parameter

PARKED = ("van", "car")  # in the way of the oncoming vehicle, the nearer to the ego first
BETWEEN_M = 2.0  # bumpers of the parked
CHANGE_M = 12.0  # along the way, to get round them and back
CLEARS_M = 1.0  # it keeps to the parked ones' side before it goes back, from middle to bumper


class NarrowedStreet(OutOfLane):
    """Cars stand half in the opposite lane; an oncoming vehicle drives round them, in the middle of the street.

    NHTSA pre-crash scenario 20, vehicles from opposite directions, one making a maneuver. The other is between the
    parked cars before the ego is there. Only one can pass at a time: the ego has to wait in front of the narrow place,
    and far enough from it that the other gets back into its lane.
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("kind", ("car", "suv", "van"), "the oncoming vehicle"),
        Number("speed", 6.0, 3.5, 9.0, "m/s", "of the oncoming vehicle"),
        Number(
            "into_lane", 1.3, 1.0, 1.8, "m", "by which the middle of the parked cars lies in from the lane's right edge"
        ),
        Number("room", 0.5, 0.3, 1.0, "m", "between the parked cars and the oncoming vehicle"),
        Number("meets", 55.0, 45.0, 70.0, "m", "ahead of the trigger point: where the narrow place begins"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 80.0, "precipitation": 20.0, "sun_altitude_angle": 40.0}

    @property
    def narrow_m(self) -> float:
        """The length of the narrow place."""
        return sum(2.0 * HALF_LENGTH_M[kind] for kind in PARKED) + BETWEEN_M

    @property
    def parked_right_m(self) -> float:
        """Of the opposite lane's middle, to the right in its direction."""
        return self.place.width_m(self.back_m) / 2.0 - self.number("into_lane")

    @property
    def out_m(self) -> float:
        """Before the parked cars, with room to get round them."""
        half_m = HALF_LENGTH_M[self.choice("kind")]
        return self.back_m + self.narrow_m + half_m + CLEARS_M + CHANGE_M

    @property
    def aside_m(self) -> float:
        """Past the parked cars with some room."""
        return 1.0 + self.number("room") + 1.0 - self.parked_right_m

    @property
    def change_m(self) -> tuple[float, float]:
        """As long to get out as to get back."""
        return CHANGE_M, CHANGE_M

    def actors(self) -> Sequence[ActorSpec]:
        """The oncoming vehicle, and the parked cars, which look its way."""
        half_m = HALF_LENGTH_M[self.choice("kind")]
        near_m, parked = self.back_m + half_m + CLEARS_M, []
        for index, kind in enumerate(PARKED):
            middle_m = near_m + HALF_LENGTH_M[kind]
            lane = oncoming(self.place, middle_m + 1.0, middle_m - 1.0, self.parked_right_m)
            parked.append(ActorSpec(f"parked {index + 1}", BLUEPRINTS[kind], lane.at(1.0)))
            near_m += 2.0 * HALF_LENGTH_M[kind] + BETWEEN_M
        return [*super().actors(), *parked]
