"""The characteristics that each case states, compared with the map and with rehearsals of the case.

A rehearsal has two drivers: one that reacts to nothing, and one that brakes. The conflict lies where each of them is
nearest to a partner, or where a partner first comes into the ego's lane. What a case states of the place must be true
of one of these three places.
"""

import re
from collections.abc import Callable, Collection
from pathlib import Path as File
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import linden
from basu.records.partners import Partner, partner_of
from basu.scenarios.cases import open_library
from basu.scenarios.characteristics import Obstruction, Surface, Violation, characteristics_of
from basu.scenarios.paths import Path
from basu.scenarios.risk.injuries import MPH_MPS
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import EGO
from basu.scenarios.suites.suite import read_suite
from basu.testing import careful, rehearse, steady
from basu.testing.rehearsal import Driver, Rehearsal
from road_there import HIGHWAY_MPS, RoadThere, road_there

Laid = Callable[..., Scenario]
LIBRARY = open_library()
SHUTTLE_MPS = 6.0
MOVED_M = 0.5
HALF_CAR_M = 1.0
OVER_MPS = 1.0  # above the posted limit, from where another speeds
SIGNALS = {Violation.RED_LIGHT: "1000001", Violation.STOP_SIGN: "206"}
AHEAD_M = 80.0  # of another's start, in which it passes the sign or the light


class Met(NamedTuple):
    """Where the conflict of a rehearsal lies."""

    s_m: float  # along the ego's route
    rehearsal: Rehearsal
    partner: str | None  # None where the ego's own course is disturbed
    enters_s_m: float | None  # where that partner first is in the ego's lane, once the conflict began


def met(scenario: Scenario, driver: Driver) -> Met:
    """Play a case; the partner is the one that comes nearest, and without one the middle of the disturbance counts."""
    played = rehearse(scenario, driver)
    first = round(played.phases_s["conflict"] / 0.05)
    ego = played.trails[EGO]
    found: list[tuple[float, int, str]] = []
    for name, trail in _partners(played, scenario.partners()).items():
        away_m = np.hypot(*(trail[first:, :2] - ego[first:, :2]).T)
        if np.isfinite(away_m).any():
            at = int(np.nanargmin(away_m))
            found.append((float(away_m[at]), first + at, name))
    if not found:
        last = min(round(played.phases_s.get("resolution", played.times_s[-1]) / 0.05), len(played.ego_s_m) - 1)
        return Met(float(played.ego_s_m[first] + played.ego_s_m[last]) / 2.0, played, None, None)
    _, at, name = min(found)
    route, way = scenario.place.route, Path.through(scenario.place.route.points_m)
    trail = played.trails[name]
    near = [way.nearest(x_m, y_m) for x_m, y_m in trail[first:, :2] if np.isfinite(x_m)]
    half_m = float(route.lane_width_m.min()) / 2.0
    enters = next((each.s_m for each in near if abs(each.right_m) < half_m and 0.5 < each.s_m < route.length_m), None)
    return Met(way.nearest(*trail[at, :2]).s_m, played, name, enters)


def _partners(played: Rehearsal, named: Collection[str] | None) -> dict[str, NDArray[np.float64]]:
    """Return the named actors. Without a name, return the moving actors, or all actors if none moves."""
    others = {name: trail for name, trail in played.trails.items() if name != EGO}
    if named is not None:
        return {name: trail for name, trail in others.items() if name in named}
    return {name: trail for name, trail in others.items() if _moved_m(trail) >= MOVED_M} or others


def _moved_m(trail: NDArray[np.float64]) -> float:
    there = trail[np.isfinite(trail[:, 0])]
    return float(np.hypot(*(there[:, :2] - there[0, :2]).T).max()) if len(there) else 0.0


@pytest.mark.parametrize("name", [case.name for case in LIBRARY.cases])
def test_a_case_states_what_the_map_and_its_rehearsal_show(laid: Laid, name: str) -> None:
    (playable,) = LIBRARY.of_id(name)
    stated = characteristics_of(playable.case, playable.scenario)
    route = laid(name).place.route
    calm, blind = met(laid(name), careful(SHUTTLE_MPS)), met(laid(name), steady(SHUTTLE_MPS))
    said = RoadThere(stated.junction.value, stated.control.value, stated.alignment.value, stated.highway.value)
    there = [road_there(route, s_m) for s_m in (calm.s_m, blind.s_m, blind.enters_s_m) if s_m is not None]
    assert said[:2] in [each[:2] for each in there], there
    assert said.alignment in [each.alignment for each in there], there
    assert said.highway in [each.highway for each in there], there
    assert (stated.surface is Surface.SLIPPERY) == any(each.what == "friction" for each in calm.rehearsal.commands)
    limit_mps = float(route.speed_limit_mps[min(int(calm.s_m), len(route.s_m) - 1)])
    fastest_mps = max(
        (float(np.nanmax(t[:, 3])) for n, t in calm.rehearsal.trails.items() if n != EGO and np.isfinite(t).any()),
        default=0.0,
    )
    assert stated.speeding.value == ("yes" if fastest_mps > limit_mps + OVER_MPS else "no"), (fastest_mps, limit_mps)


@pytest.mark.parametrize("name", [case.name for case in LIBRARY.cases])
def test_another_breaks_the_rule_of_the_road_that_its_case_states(laid: Laid, name: str) -> None:
    (playable,) = LIBRARY.of_id(name)
    stated = characteristics_of(playable.case, playable.scenario).violation
    scenario = laid(name)
    found = met(scenario, steady(SHUTTLE_MPS))
    assert (stated is Violation.WRONG_SIDE) == _comes_towards(scenario, found)
    if stated in SIGNALS:
        assert found.partner is not None
        start = scenario.place.carla_map.get_waypoint(_location(scenario, found.partner))
        assert start.get_landmarks_of_type(AHEAD_M, SIGNALS[stated])


@pytest.mark.parametrize("name", [case.name for case in LIBRARY.cases])
def test_the_stated_partner_is_in_the_cast_and_a_stated_obstruction_hides_it(laid: Laid, name: str) -> None:
    (playable,) = LIBRARY.of_id(name)
    stated, scenario = characteristics_of(playable.case, playable.scenario), laid(name)
    cast = {spec.name: partner_of(spec.blueprint) for spec in scenario.actors()}
    if stated.partner not in (Partner.NONE, Partner.SIGN, Partner.LIGHT):
        assert stated.partner in cast.values()
    if stated.obstruction is Obstruction.VEHICLE:
        played = rehearse(scenario, steady(SHUTTLE_MPS))
        vehicles = [role for role, kind in cast.items() if kind is Partner.VEHICLE]
        hidden = [(one, by) for one in cast for by in vehicles if one != by and _is_hidden(played, one, by)]
        assert hidden, cast


def _is_hidden(played: Rehearsal, one: str, by: str) -> bool:
    """Whether the line from the ego to an actor passes within half a car's width of another one's middle."""
    ego, partner, other = (played.trails[role][:, :2] for role in (EGO, one, by))
    way, away = partner - ego, other - ego
    along = np.clip((way * away).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-9), 0.0, 1.0)
    return bool((np.hypot(*(away - along[:, None] * way).T)[(along > 0.0) & (along < 1.0)] < HALF_CAR_M).any())


@pytest.mark.parametrize("town", ["Linden", "Linden_thesis"])
def test_linden_has_no_highway_so_no_case_can_have_one(town: str) -> None:
    text = (File(linden.__file__).parent / "data" / f"{town}.xodr").read_text(encoding="utf-8")
    posted = {(float(most), unit) for most, unit in re.findall(r'<speed [^>]*max="([0-9.]+)"[^>]*unit="(.*?)"', text)}
    assert {unit for _, unit in posted} == {"mph"}
    assert max(most for most, _ in posted) == 35.0
    assert 35.0 * MPH_MPS < HIGHWAY_MPS < 45.1 * MPH_MPS
    about = " ".join(read_suite("nhtsa").about)
    assert "No case lies on a highway: the map of Linden posts 35 mph at the most" in about


def _location(scenario: Scenario, role: str) -> object:
    import carla  # noqa: PLC0415 - a type of the official client, needed here alone

    pose = next(spec.pose for spec in scenario.actors() if spec.name == role)
    return carla.Location(pose.x_m, pose.y_m, pose.z_m)


def _comes_towards(scenario: Scenario, found: Met) -> bool:
    """Whether a vehicle comes head-on while its middle is in the ego's lane, outside junctions."""
    route, way = scenario.place.route, Path.through(scenario.place.route.points_m)
    for name, trail in found.rehearsal.trails.items():
        if name == EGO:
            continue
        for x_m, y_m, yaw_rad, speed_mps in trail[np.isfinite(trail[:, 0])][::4]:
            near = way.nearest(x_m, y_m)
            index = min(int(near.s_m), len(route.s_m) - 1)
            against = np.cos(yaw_rad - way.heading_rad(near.s_m)) < -0.7
            inside = abs(near.right_m) < route.lane_width_m[index] / 2.0 and 1.0 < near.s_m < route.length_m - 1.0
            if against and inside and speed_mps > 1.0 and not route.is_junction[index]:
                return True
    return False
