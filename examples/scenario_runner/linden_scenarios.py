"""Two scenarios for ScenarioRunner in Linden: an unsignalised intersection and a roundabout.

ScenarioRunner has no roundabout, and its ``NoSignalJunctionCrossing`` has the coordinates of Town03 in its code. These
classes take all places from their XML, `linden_scenarios.xml` beside this file.
`docs/how-to/scenario-runner.md` says how to run them.
"""

from __future__ import annotations

import carla
from py_trees.common import ParallelPolicy
from py_trees.composites import Parallel, Sequence
from srunner.scenariomanager.carla_data_provider import CarlaDataProvider
from srunner.scenariomanager.scenarioatomics.atomic_behaviors import ActorFlow, Idle, WaypointFollower
from srunner.scenariomanager.scenarioatomics.atomic_criteria import CollisionTest, RunningStopTest
from srunner.scenariomanager.scenarioatomics.atomic_trigger_conditions import InTriggerDistanceToLocation
from srunner.scenarios.basic_scenario import BasicScenario

ARRIVED_M = 8.0  # from the hero to its exit: the scenario is over


class DriveTo(WaypointFollower):
    """Drive from wherever the actor is to a place, along the shortest way."""

    def __init__(self, actor, location, speed_mps):
        """The way is looked up in the first frame."""
        super().__init__(actor, speed_mps, name=f"drive on at {speed_mps:g} m/s")
        self._destination = location

    def initialise(self):
        """Look up the way from here."""
        here = CarlaDataProvider.get_location(self._actor)
        self._plan = CarlaDataProvider.get_global_route_planner().trace_route(here, self._destination)
        return super().initialise()


class AtPlaces(BasicScenario):
    """The base of both: reads places and numbers from the elements of the case's XML."""

    def __init__(  # the signature is ScenarioRunner's
        self,
        world,
        ego_vehicles,
        config,
        randomize=False,  # noqa: FBT002
        debug_mode=False,  # noqa: FBT002
        criteria_enable=True,  # noqa: FBT002
        timeout=90,
    ):
        """Build the scenario; ``randomize`` changes nothing."""
        del randomize
        self.timeout = timeout
        super().__init__(type(self).__name__, ego_vehicles, config, world, debug_mode, criteria_enable=criteria_enable)

    @property
    def hero(self):
        """The vehicle under test."""
        return self.ego_vehicles[0]

    def location(self, name):
        """The place ``<name x="" y="" z=""/>``."""
        return carla.Location(*(float(self._element(name)[axis]) for axis in "xyz"))

    def value(self, name, otherwise):
        """The number ``<name value=""/>``; ``otherwise`` where the case gives none."""
        return float(self.config.other_parameters.get(name, {"value": otherwise})["value"])

    def hero_within(self, distance_m, of):
        """The hero is nearer to a place than so many metres."""
        return InTriggerDistanceToLocation(self.hero, self.location(of), distance_m)

    def _element(self, name):
        if name not in self.config.other_parameters:
            raise ValueError(f'{self.config.name} needs an element <{name} x="" y="" z=""/>')
        return self.config.other_parameters[name]


class LindenUnsignalizedIntersection(AtPlaces):
    """At a junction without lights another vehicle makes for the point that the hero has to cross.

    It sets off slowly when the hero is within ``first`` metres of ``<meeting>``, and accelerates once the hero is at
    its line, within ``second`` metres. The case places it as ``<other_actor>``; it leaves at ``<leaves>``, the hero at
    ``<exit>``.
    """

    def _create_behavior(self):
        (other,), leaves = self.other_actors, self.location("leaves")
        comes = Parallel("comes", policy=ParallelPolicy.SUCCESS_ON_ONE)
        comes.add_children(
            [
                DriveTo(other, leaves, self.value("slowly", 4.5)),
                self.hero_within(self.value("second", 18.0), "meeting"),
            ]
        )
        goes_on = Parallel("goes on", policy=ParallelPolicy.SUCCESS_ON_ONE)
        goes_on.add_children(
            [
                Sequence("leaves", children=[DriveTo(other, leaves, self.value("speed", 8.0)), Idle()]),
                self.hero_within(ARRIVED_M, "exit"),
            ]
        )
        root = Sequence("negotiation")
        root.add_children([self.hero_within(self.value("first", 50.0), "meeting"), comes, goes_on])
        return root

    def _create_test_criteria(self):
        return [CollisionTest(self.hero), RunningStopTest(self.hero)]


class LindenRoundabout(AtPlaces):
    """The hero enters a roundabout among circulating traffic and leaves it by the exit of its way.

    Cars come in one after another at ``<source>``, pass the hero's entry and leave at ``<sink>``, until the hero is at
    ``<exit>``.
    """

    def _initialize_actors(self, config):
        town = CarlaDataProvider.get_map()
        self._source, self._sink = town.get_waypoint(self.location("source")), town.get_waypoint(self.location("sink"))

    def _create_behavior(self):
        apart_m = [self.value("least_apart", 18.0), self.value("most_apart", 40.0)]
        root = Parallel("circulating traffic", policy=ParallelPolicy.SUCCESS_ON_ONE)
        root.add_children(
            [
                ActorFlow(self._source, self._sink, apart_m, 5.0, self.value("speed", 4.5), initial_actors=True),
                self.hero_within(ARRIVED_M, "exit"),
            ]
        )
        return root

    def _create_test_criteria(self):
        return [CollisionTest(self.hero)]
