"""An example of a scenario: a bin lorry stands in the lane, and drives on after a while.

Its case is in bin_lorry.xml beside this file: `basu scenario run examples/scenarios/bin_lorry.xml --agent basic`
"""

from basu.scenarios.actions import DriveAlong, InTurn, Wait
from basu.scenarios.criteria import Arrives, InTime, LeastDistance, NoCollision
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoNear

LORRY = "lorry"
MODELS = {"lorry": "vehicle.carlamotors.carlacola", "van": "vehicle.mercedes.sprinter"}
LEAVES_AT_MPS = 6.0


class BinLorry(Scenario):
    """A bin lorry stands in the lane and drives on after a while."""

    group = Group.REAR_END
    parameters = (
        Number("ahead", 50.0, 30.0, 80.0, "m", "from the trigger point to the lorry's middle"),
        Number("stands", 6.0, 2.0, 15.0, "s", "once the ego is near"),
        Choice("vehicle", tuple(MODELS), "what stands there"),
    )

    def actors(self):
        """The lorry in the ego's lane."""
        model = MODELS[self.choice("vehicle")]
        return [ActorSpec(LORRY, model, self.place.at(self.number("ahead")))]

    def trigger(self):
        """The ego comes near."""
        return EgoNear(LORRY, 20.0)

    def conflict(self):
        """The lorry stands in the way, then it drives off, out of the ego's sight."""
        begin_m = self.place.trigger_s_m + self.number("ahead")
        way = Path.of_route(self.place.route, begin_m, self.place.route.length_m)
        return InTurn(
            Wait(self.number("stands")),
            DriveAlong(LORRY, way, LEAVES_AT_MPS, at_end="vanish"),
        )

    def criteria(self):
        """The ego touches nothing, keeps its distance, and arrives in time."""
        return [NoCollision(), LeastDistance(0.5, to=LORRY), Arrives(), InTime()]
