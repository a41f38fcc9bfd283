"""Triggers of scenarios as conditions of OpenSCENARIO, each by its class; a class that is not here is refused.

Distances along the ego's route become distances that it has travelled. Positions on roads would be measured along the
reference lines of the roads. In a bend these are metres longer or shorter than the lane.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from py_trees.common import ParallelPolicy
from py_trees.composites import Parallel
from scenariogeneration import xosc

from basu.errors import ScenarioError
from basu.metrics.path_following import AT_END_M
from basu.scenarios import triggers
from basu.scenarios.stage import EGO
from basu.scenarios.triggers.along_route import COMFORT_MPS2, SLACK_M
from basu_openscenario.exporting.motions import at_rest

if TYPE_CHECKING:
    from collections.abc import Callable

    from py_trees.behaviour import Behaviour

    from basu.routing import Route
    from basu.testing import Rehearsal

BAND_MPS = 0.5
"""Times to a place are compared in bands of the ego's speed, because no condition has a time along a route."""
FASTEST_MPS = 16.0
"""The highest band."""
SPARE_M = 0.02
"""A place at the end of the ego's way counts as reached so much earlier: the points of its trajectory are rounded."""
STILL_M = 0.05
"""An actor that moves by less in the whole rehearsal stands."""


@dataclass(frozen=True, slots=True)
class ExportedTest:
    """A condition: of an entity, or of the time where that is None."""

    entity: str | None
    condition: object
    delay_s: float = 0.0


Tests: TypeAlias = tuple[tuple[ExportedTest, ...], ...]
"""Groups of tests: true where all tests of one group are."""


@dataclass(frozen=True, slots=True)
class RehearsedCase:
    """What the conditions of a case are made of."""

    route: Route
    played: Rehearsal
    step_s: float

    def travelled_m(self, s_m: float) -> float:
        """Return how far the ego has travelled at a place of its route, in m along its own path.

        The rehearsal ends where the last trigger holds, and so does the trajectory of the ego. ``SPARE_M`` less are
        enough there. Otherwise a player that rounds a path down by a millimetre would wait for ever.
        """
        way = at_rest(self.played.trails[EGO])[0][:, :2]
        path_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(way, axis=0).T))])
        along_m = np.maximum.accumulate(self.played.ego_s_m)
        beyond_m = s_m - float(along_m[-1])
        return float(np.interp(s_m, along_m, path_m)) + (beyond_m - SPARE_M if beyond_m > -SPARE_M else 0.0)

    def frame_at(self, time_s: float) -> int:
        """Return the frame at a time."""
        return int(np.searchsorted(self.played.times_s, time_s - 1e-6))


def tests_of(node: Behaviour, case: RehearsedCase) -> Tests:
    """Return a trigger, or a parallel node of triggers, as groups of tests.

    Raises:
        ScenarioError: it has no counterpart.
    """
    if isinstance(node, Parallel):
        each = [tests_of(child, case) for child in node.children]
        if isinstance(node.policy, ParallelPolicy.SuccessOnAll):
            return tuple(tuple(itertools.chain(*groups)) for groups in itertools.product(*each))
        return tuple(itertools.chain(*each))
    kind = type(node)
    if kind not in TRIGGERS:
        raise ScenarioError(f"the trigger {kind.__name__} has no counterpart in OpenSCENARIO")
    return TRIGGERS[kind](node, case)


def _travelled(case: RehearsedCase, s_m: float) -> ExportedTest:
    """Return the test whether the ego has come so far along its route."""
    return ExportedTest(EGO, xosc.TraveledDistanceCondition(round(case.travelled_m(s_m), 3)))


def _passes(node: triggers.EgoPasses, case: RehearsedCase) -> Tests:
    """Return the test for a place of the route."""
    return ((_travelled(case, node.s_m),),)


def _fired(node: Behaviour, case: RehearsedCase) -> Tests:
    """Return the test for the place of the route at which a trigger came true that depends on the route alone."""
    at_s = case.played.spans_s[node][1]
    assert at_s is not None, "a guard came true"
    return ((_travelled(case, float(case.played.ego_s_m[case.frame_at(at_s)])),),)


def _arrives(_: triggers.EgoArrives, case: RehearsedCase) -> Tests:
    """Return the test for the end of the route."""
    return ((_travelled(case, case.route.length_m - AT_END_M - SLACK_M),),)


def _beyond(node: triggers.EgoBeyond, case: RehearsedCase) -> Tests:
    """Return the test for an actor behind the ego, where that actor stands.

    Raises:
        ScenarioError: it moves.
    """
    trail = case.played.trails[node.actor][:, :2]
    if float(np.ptp(trail[~np.isnan(trail[:, 0])], axis=0).max(initial=0.0)) > STILL_M:
        raise ScenarioError("the trigger EgoBeyond has no counterpart in OpenSCENARIO for an actor that moves")
    return _fired(node, case)


def _bands(node: Behaviour, case: RehearsedCase, s_m: float, reach_m: Callable[[float], float]) -> Tests:
    """Return the tests for a place that the ego is to reach in some time: in each band of speed, a distance.

    The middle of one band is the speed at which the trigger came true in the rehearsal. Its distance is the one of that
    moment.

    Args:
        node: the trigger.
        case: the case.
        s_m: the place, along the route.
        reach_m: the distance before the place at which the trigger comes true, from the ego's speed in m/s; rising.
    """
    at_s = case.played.spans_s[node][1]
    assert at_s is not None, "a guard came true"
    frame = case.frame_at(at_s)
    fired_mps = float(case.played.trails[EGO][frame, 3])
    found: list[tuple[ExportedTest, ...]] = [(_travelled(case, s_m),)]
    for nth in range(-math.floor(fired_mps / BAND_MPS), math.ceil((FASTEST_MPS - fired_mps) / BAND_MPS)):
        middle_mps = fired_mps + nth * BAND_MPS
        from_m = s_m - reach_m(middle_mps) if nth else float(case.played.ego_s_m[frame])
        faster = xosc.SpeedCondition(round(max(middle_mps - BAND_MPS / 2.0, 0.0), 3), xosc.Rule.greaterThan)
        found.append((ExportedTest(EGO, faster), _travelled(case, from_m)))
    return tuple(found)


def _arrival(node: triggers.TimeToArrival, case: RehearsedCase) -> Tests:
    """Return the tests for a time to a place."""
    return _bands(node, case, node.s_m, lambda speed_mps: speed_mps * node.seconds)


def _rest(node: triggers.TimeToRest, case: RehearsedCase) -> Tests:
    """Return the tests for a time to a stop; see ``basu.scenarios.triggers.along_route.rests_in_s``."""

    def reach_m(speed_mps: float) -> float:
        if speed_mps < node.seconds * COMFORT_MPS2:
            return speed_mps * node.seconds - speed_mps * speed_mps / (2.0 * COMFORT_MPS2)
        return speed_mps * node.seconds / 2.0

    return _bands(node, case, node.s_m, reach_m)


def _near(node: triggers.Near, _: RehearsedCase) -> Tests:
    """Return the test for two entities near each other."""
    near = xosc.RelativeDistanceCondition(
        node.distance_m,
        xosc.Rule.lessOrEqual,
        xosc.RelativeDistanceType.euclidianDistance,
        node.other,
        freespace=False,
        coordinate_system=xosc.CoordinateSystem.entity,
    )
    return ((ExportedTest(node.one, near),),)


def _near_place(node: triggers.NearPlace, _: RehearsedCase) -> Tests:
    """Return the test for an entity near a place."""
    near = xosc.DistanceCondition(
        node.distance_m,
        xosc.Rule.lessOrEqual,
        xosc.WorldPosition(round(node.place.x_m, 3), round(-node.place.y_m, 3)),
        freespace=False,
        distance_type=xosc.RelativeDistanceType.euclidianDistance,
        coordinate_system=xosc.CoordinateSystem.entity,
    )
    return ((ExportedTest(node.actor, near),),)


def _speed(rule: object) -> Callable[[triggers.Faster | triggers.Slower, RehearsedCase], Tests]:
    """Return the test for a speed."""

    def tests(node: triggers.Faster | triggers.Slower, _: RehearsedCase) -> Tests:
        return ((ExportedTest(node.actor, xosc.SpeedCondition(node.speed_mps, rule)),),)

    return tests


def _stands(node: triggers.StandsStill, case: RehearsedCase) -> Tests:
    """Return the test for an entity that stands; a player sees a rest begin two steps later than the rehearsal."""
    seconds = max(node.seconds - 2.0 * case.step_s, 0.0)
    return ((ExportedTest(node.actor, xosc.StandStillCondition(round(seconds, 3))),),)


def _elapsed(node: triggers.Elapsed, _: RehearsedCase) -> Tests:
    """Return the test for a time."""
    return ((ExportedTest(None, xosc.SimulationTimeCondition(node.seconds, xosc.Rule.greaterOrEqual)),),)


def _touches(node: triggers.EgoTouches, _: RehearsedCase) -> Tests:
    """Return the test for a contact of the ego with one actor, or with any."""
    kinds = (xosc.ObjectType.vehicle, xosc.ObjectType.pedestrian, xosc.ObjectType.miscellaneous)
    return tuple((ExportedTest(EGO, xosc.CollisionCondition(one)),) for one in ((node.actor,) if node.actor else kinds))


TRIGGERS: dict[type, Callable[..., Tests]] = {
    triggers.EgoArrives: _arrives,
    triggers.EgoBeyond: _beyond,
    triggers.EgoEntersJunction: _fired,
    triggers.EgoLeavesJunction: _fired,
    triggers.EgoNear: _near,
    triggers.EgoPasses: _passes,
    triggers.EgoTouches: _touches,
    triggers.Elapsed: _elapsed,
    triggers.Faster: _speed(xosc.Rule.greaterOrEqual),
    triggers.Near: _near,
    triggers.NearPlace: _near_place,
    triggers.Slower: _speed(xosc.Rule.lessOrEqual),
    triggers.StandsStill: _stands,
    triggers.TimeToArrival: _arrival,
    triggers.TimeToRest: _rest,
}
"""What each trigger becomes."""
