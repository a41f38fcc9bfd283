"""The base of all scenarios and their behaviour tree: setup, trigger, conflict, resolution, end (figure 4.4).

A scenario of your own is one class and one case::

    class ParkedCar(Scenario):
        \"\"\"A car stands in the lane.\"\"\"

        group = Group.REAR_END
        parameters = (Number("ahead", 40.0, 20.0, 80.0, "m", "of the trigger point"),)

        def actors(self):
            return [ActorSpec("parked", "vehicle.audi.a2", self.place.at(self.number("ahead")))]

        def trigger(self):
            return EgoNear("parked", 30.0)

        def conflict(self):
            return Wait(1.0)

        def criteria(self):
            return [NoCollision(), Arrives()]

See `docs/reference/scenarios.md`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from py_trees.behaviour import Behaviour
from py_trees.composites import Sequence as Steps
from py_trees.trees import BehaviourTree

from basu.scenarios.exercise import came_about
from basu.scenarios.triggers import EgoArrives

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from basu.scenarios.criteria.criterion import Criterion, Played
    from basu.scenarios.exercise import Finding
    from basu.scenarios.nhtsa import Group
    from basu.scenarios.parameters import Parameter, Value
    from basu.scenarios.place import Place
    from basu.scenarios.stage import ActorSpec, Stage
    from basu.scenarios.xml_elements import Case


class Scenario(ABC):
    """Actors, behaviour and criteria at a place. The first line of the class's docstring is its title.

    Attributes:
        place: the ego's route and where the scenario lies on it.
        values: of all parameters, by name.
    """

    group: ClassVar[Group]
    parameters: ClassVar[Sequence[Parameter]] = ()
    weather: ClassVar[Mapping[str, float]] = {}  # fields of carla.WeatherParameters, where the case gives none
    timeout_s: ClassVar[float] = 60.0  # of simulated time from the first frame to the end
    needs_m: ClassVar[float] = 60.0  # of the ego's route behind the trigger point
    needs_junction: ClassVar[bool] = False  # behind it: a case without a destination goes on to the next
    aliases: ClassVar[Sequence[str]] = ()  # types of ScenarioRunner and the leaderboard that mean this one
    characteristics: ClassVar[Mapping[str, str]] = {}  # fields of `basu.scenarios.characteristics`
    pre_crash: ClassVar[tuple[int, ...]] = ()  # numbers in DOT HS 810 767; BASU's are in `basu.scenarios.nhtsa`
    reference: ClassVar[str] = "behavioral"  # an agent that comes with BASU and passes every case
    partner_choice: ClassVar[tuple[str, Mapping[str, str]] | None] = None  # parameter that chooses its blueprint

    def __init__(self, place: Place, values: Mapping[str, Value]) -> None:
        """Take the place and the values; nothing is in the world yet."""
        self.place, self.values = place, values

    @classmethod
    def settled(cls, case: Case, values: Mapping[str, Value]) -> Case:
        """Return the case with its place and its ego. A class overrides this if its places depend on its values."""
        del values
        return case

    @classmethod
    def title(cls) -> str:
        """What it is, in a line."""
        return (cls.__doc__ or cls.__name__).strip().splitlines()[0]

    def number(self, name: str) -> float:
        """The value of a parameter that is a number."""
        value = self.values[name]
        assert isinstance(value, float), f"{name} is a choice"
        return value

    def choice(self, name: str) -> str:
        """The value of a parameter that is a choice."""
        value = self.values[name]
        assert isinstance(value, str), f"{name} is a number"
        return value

    def actors(self) -> Sequence[ActorSpec]:
        """The actors besides the ego; they are spawned before the first frame."""
        return ()

    def setup(self) -> Behaviour | None:
        """What is made ready in the first frame: friction, lights, weather that the case cannot give."""
        return None

    @abstractmethod
    def trigger(self) -> Behaviour:
        """What has to come true for the conflict to begin."""

    @abstractmethod
    def conflict(self) -> Behaviour:
        """What others do to the ego, and ends when the ego has had to answer."""

    def resolution(self) -> Behaviour:
        """What has to come true for the conflict to be over; here, the ego arrives at the end of its route."""
        return EgoArrives()

    def end(self) -> Behaviour | None:
        """What is left to be done once it is over, such as a light given back to its cycle."""
        return None

    @abstractmethod
    def criteria(self) -> Sequence[Criterion]:
        """Return the criteria of this scenario; the policy adds its own (`basu.scenarios.policy`)."""

    def partners(self) -> Collection[str] | None:
        """Return the roles and things that the ego must avoid; None means the actors that move, or all if none does."""
        return None

    def exercised(self, played: Played) -> Finding:
        """Return whether the conflict came about (`basu.scenarios.exercise`); a scenario may define its own effect."""
        return came_about(played, self.partners())


PHASES = ("setup", "trigger", "conflict", "resolution", "end")


class Composed(NamedTuple):
    """A scenario's tree and its phases by name, in the order in which they are passed."""

    root: BehaviourTree
    phases: dict[str, Behaviour]


def compose(scenario: Scenario) -> Composed:
    """The tree of a scenario, not yet set on a stage."""
    phases: dict[str, Behaviour] = {}
    for phase in PHASES:
        node = getattr(scenario, phase)()
        step = Steps(phase, memory=True, children=[] if node is None else [node])
        phases[phase] = step
    root = Steps(type(scenario).__name__, memory=True, children=list(phases.values()))
    return Composed(BehaviourTree(root), phases)


def set_on(composed: Composed, stage: Stage) -> None:
    """Give every node of a tree its stage."""
    composed.root.setup(stage=stage)
