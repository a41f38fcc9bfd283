"""A vehicle turns left in front of the ego: NHTSA's "left turn across path from opposite directions"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.library.crossing_paths.from_the_side import AcrossTheWay, green_for_ego, has_light
from basu.scenarios.parameters import Choice, Number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.parameters import Parameter
    from basu.scenarios.paths.crossings import Side


class LeftTurnAcrossPath(AcrossTheWay):
    """An oncoming car turns left in front of the ego.

    NHTSA pre-crash scenarios 27 and 29, left turn across path from opposite directions. The ego goes straight on and
    has the right of way; nothing in the other's way of driving tells that it will turn until it does. It turns as
    slowly as an inattentive driver: an ego that brakes at once keeps a second to a collision. With a short
    ``notice`` it has waited in the junction and sets off late.
    """

    turn = "left"
    comes_before = True
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("kind", ("car", "van", "suv", "motorcycle"), "the turning vehicle"),
        Number("speed", 3.0, 2.5, 7.0, "m/s", "of the other in its turn"),
        Number("lateness", -1.8, -3.0, 0.5, "s", "after the ego at the place where they meet; negative: before it"),
        Number("notice", 5.5, 3.0, 7.0, "s", "before the ego's arrival, when the other sets off"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 10.0, "sun_altitude_angle": 15.0}

    @property
    def side(self) -> Side:
        """From ahead."""
        return "opposite"

    def setup(self) -> Behaviour | None:
        """Where there are lights, the ego's is green."""
        return green_for_ego(self.place) if has_light(self.place) else None
