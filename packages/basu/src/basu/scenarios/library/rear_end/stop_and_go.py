"""Rear-end: a leader that stops and goes, ever again."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from basu.scenarios.actions import Brake, DriveAlong, Hold, InTurn
from basu.scenarios.library.rear_end.follow_leading_vehicle import LEADER, MODELS
from basu.scenarios.library.rear_end.lead_vehicle_brakes import LeadVehicleBrakes
from basu.scenarios.parameters import Choice, Number

if TYPE_CHECKING:
    from collections.abc import Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.parameters import Parameter


class StopAndGo(LeadVehicleBrakes):
    """The vehicle ahead drives off, stops, drives off and stops again, as in a queue.

    Each time it comes to stand a little later and for a little shorter, so that no driver can keep the beat. NHTSA
    pre-crash scenario: lead vehicle stopped, at the end of a queue. Fair as LeadVehicleBrakes.
    """

    aliases = ()
    parameters: ClassVar[Sequence[Parameter]] = (
        Choice("leader", tuple(MODELS), "the leader"),
        Number("ahead", 10.0, 8.0, 20.0, "m", "from the trigger point to the leader's middle at first"),
        Number("speed", 4.5, 2.0, 6.0, "m/s", "of the leader where it has time to reach it"),
        Number("stride", 14.0, 8.0, 25.0, "m", "that it drives the first time; a tenth more each time"),
        Number("stops", 3.0, 1.0, 5.0, "", "times that it stops; rounded"),
        Number("brake", 4.0, 1.5, 8.0, "m/s²", "of the leader"),
        Number("stands", 2.0, 0.5, 4.0, "s", "that it stands the first time; a tenth less each time"),
    )
    timeout_s = 60.0

    def conflict(self) -> Behaviour:
        """Stop and go."""
        way, speed_mps = self.way(), self.number("speed")
        steps: list[Behaviour] = []
        driven_m = 0.0
        for number in range(round(self.number("stops"))):
            driven_m += self.number("stride") * (1.0 + 0.1 * number)
            steps += [
                DriveAlong(LEADER, way, speed_mps, to_m=driven_m, at_end="go on"),
                Brake(LEADER, at_mps2=self.number("brake"), path=way),
                Hold(LEADER, self.number("stands") * (1.0 - 0.1 * number)),
            ]
        return InTurn(*steps, name="stops and goes")
