"""A vehicle runs a red light: NHTSA's "running red light"."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.library.crossing_paths.from_the_side import AcrossTheWay, green_for_ego
from basu.scenarios.parameters import Choice, Number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.parameters import Parameter


class RedLightRunner(AcrossTheWay):
    """The ego has a green light, and a car from the side runs its red one.

    NHTSA pre-crash scenario 4, running red light. The other has its speed 1.8 s before they would meet and keeps it:
    an ego that looks to the side brakes in time, one that trusts the light alone is hit.
    """

    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("side", ("left", "right"), "from which the other comes"),
        Choice("kind", ("car", "van", "suv", "motorcycle"), "the other vehicle"),
        Number("speed", 8.0, 5.0, 13.0, "m/s", "of the other: 8 m/s are 18 mph"),
        Number("lateness", -0.6, -1.5, 1.0, "s", "after the ego at the place where they meet; negative: before it"),
        Number("notice", 6.0, 4.0, 7.0, "s", "before the ego's arrival, when the other sets off"),
    )
    weather: ClassVar[Mapping[str, float]] = {"cloudiness": 20.0, "sun_altitude_angle": 35.0}
    aliases: ClassVar[Sequence[str]] = ("OppositeVehicleRunningRedLight",)

    def setup(self) -> Behaviour:
        """Green for the ego, red for all others."""
        return green_for_ego(self.place)
