"""Claims about scenarios on the way of a route: read, laid, met, judged, and gone without a trace."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import carla
import numpy as np
import pytest

from basu.cli import main
from basu.errors import ScenarioError
from basu.managers.placed_scenario import is_behind, place_scenario
from basu.managers.scenario_manager import Playing
from basu.managers.scenario_results import results_of
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.outcome import Outcome, Status
from basu.output.report.console import scenario_lines
from basu.output.report.documents import RESULT_SCHEMA, mistakes, read_schema
from basu.routing import Route
from basu.routing.planned_route import until
from basu.routing.route_file import read_routes
from basu.running.preparation import prepare
from basu.running.series import conditions
from basu.scenarios.actions import Wait
from basu.scenarios.nhtsa import Group
from basu.scenarios.playable import Playable
from basu.scenarios.route_scenarios import scenarios_on
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec, Pose
from basu.scenarios.triggers import EgoArrives
from basu.scenarios.xml_elements import Case, GivenActor
from fakes.one_road import one_road, way_along
from servers import RunningServer, running_server

TOWN = one_road()
WAY = way_along(TOWN)
PACKAGES = Path(__file__).parents[4] / "packages"
PACKAGED = PACKAGES / "basu" / "src" / "basu" / "routes" / "linden_scenarios.xml"
LINDEN = PACKAGES / "linden" / "src" / "linden" / "data" / "Linden.xodr"


class Quiet(Scenario):
    """Nothing happens."""

    group = Group.ANIMAL
    needs_m = 20.0
    aliases: ClassVar = ("DeerOfTheirs",)

    def trigger(self) -> EgoArrives:
        return EgoArrives()

    def conflict(self) -> Wait:
        return Wait(0.0)

    def criteria(self) -> list[Any]:
        return []


def waiting_at(x_m: float, y_m: float = 1.75, yaw_deg: float = 0.0) -> Playable:
    """The quiet scenario with a trigger point."""
    trigger = Pose(x_m, y_m, 0.0, float(np.radians(yaw_deg)))
    ego = GivenActor(role="hero", model="vehicle.*", pose=trigger)
    case = Case(name="quiet_1", type="Quiet", town="OneRoad", ego=ego, trigger=trigger, source="way.xml, line 7")
    return Playable(case, Quiet, {})


def test_a_scenario_begins_at_its_trigger_point_and_ends_where_it_needs_no_more() -> None:
    laid = place_scenario(waiting_at(12.0), WAY, TOWN, own=False)
    assert laid.scenario.place.trigger_s_m == pytest.approx(10.0, abs=0.01)
    assert laid.way.length_m == pytest.approx(30.0, abs=1.0)
    assert laid.scenario.place.route is WAY  # it sees the rest of the way all the same


@pytest.mark.parametrize(
    ("waiting", "words"),
    [
        (waiting_at(12.0, 12.0), "way.xml, line 7: the trigger point of 'quiet_1' .* lies 10.2 m off the route '1'"),
        (waiting_at(12.0, yaw_deg=180.0), "looks to 180°, and the route goes to 0° there; turn it"),
        (waiting_at(30.0), "needs 20 m of the route behind its trigger point, and there are 12 m"),
    ],
)
def test_a_scenario_without_a_place_on_the_route_is_refused_in_a_sentence(waiting: Playable, words: str) -> None:
    with pytest.raises(ScenarioError, match=words):
        place_scenario(waiting, WAY, TOWN, own=False)


def there_and_round(way: Route) -> Route:
    """A route that goes its way twice, as a closed one passes its beginning again."""
    again = {name: np.concatenate([getattr(way, name)] * 2) for name in ("points_m", "yaw_rad", "lane_width_m")}
    more = {name: np.concatenate([getattr(way, name)] * 2) for name in ("speed_limit_mps", "is_junction")}
    s_m = np.concatenate([way.s_m, way.s_m + way.length_m + 1.0])
    return replace(way, **again, **more, s_m=s_m)


def test_of_two_times_that_a_route_comes_by_the_first_is_meant() -> None:
    laid = place_scenario(waiting_at(12.0), there_and_round(WAY), TOWN, own=False)
    assert laid.scenario.place.trigger_s_m == pytest.approx(10.0, abs=0.01)


def test_that_stands_in_the_lane_before_the_trigger_point_comes_later() -> None:
    place = place_scenario(waiting_at(20.0), WAY, TOWN, own=False).scenario.place
    assert is_behind(place, ActorSpec("tailgater", "vehicle.*", place.at(-8.0)))
    assert not is_behind(place, ActorSpec("leader", "vehicle.*", place.at(8.0)))
    assert not is_behind(place, ActorSpec("walker", "walker.*", place.at(-8.0, 4.0)))


@pytest.mark.parametrize("s_m", [5.3, 20.0, 39.99])
def test_a_route_cut_off_is_the_same_route_as_far_as_it_goes(s_m: float) -> None:
    cut = until(WAY, s_m)
    assert s_m - 1.1 < cut.length_m <= s_m
    assert np.array_equal(cut.points_m, WAY.points_m[: len(cut.s_m)])
    assert len(cut.waypoints) == len(cut.s_m) == len(cut.speed_limit_mps)
    assert until(WAY, 1e9) is WAY


def route_file(folder: Path, scenarios: str) -> Path:
    """140 m straight on along a street of Linden, with scenarios."""
    points = '<position x="223.3" y="114.7" z="247.3"/><position x="363.1" y="122.4" z="247.3"/>'
    path = folder / "way.xml"
    path.write_text(
        f'<routes>\n<route id="1" town="Linden"><waypoints>{points}</waypoints>\n<scenarios>\n{scenarios}\n'
        "</scenarios></route></routes>",
        encoding="utf-8",
    )
    return path


def at(name: str, kind: str, ahead_m: float, inside: str = "") -> str:
    x_m, y_m = 223.3 + ahead_m * 0.9985, 114.7 + ahead_m * 0.0550
    trigger = f'<trigger_point x="{x_m:.1f}" y="{y_m:.1f}" z="247.3" yaw="3.2"/>'
    return f'<scenario name="{name}" type="{kind}">{trigger}{inside}</scenario>'


def test_theirs_are_read_with_our_classes(tmp_path: Path) -> None:
    path = route_file(tmp_path, at("DynamicObjectCrossing_1", "DynamicObjectCrossing", 20.0, '<distance value="40"/>'))
    (description,) = read_routes(path)
    (found,) = scenarios_on(description)
    assert "DynamicObjectCrossing" in found.scenario.aliases
    assert found.case.name == "DynamicObjectCrossing_1"
    assert found.unread == ("distance",)  # their class reads it, ours does not: the result says so


def test_scenarios_can_be_skipped(tmp_path: Path) -> None:
    path = route_file(tmp_path, at("crossing_1", "PedestrianCrossing", 20.0))
    (with_them,) = prepare(RunOptions(routes=str(path))).jobs
    (without,) = prepare(RunOptions(routes=str(path), with_scenarios=False)).jobs
    assert [each.case.name for each in with_them.scenarios] == ["crossing_1"]
    assert without.scenarios == ()


def test_a_series_knows_its_scenarios(tmp_path: Path) -> None:
    given = []
    for walker in ("adult", "child"):
        path = route_file(tmp_path, at("crossing_1", "PedestrianCrossing", 20.0, f'<walker value="{walker}"/>'))
        options = RunOptions(routes=str(path))
        given.append(conditions(options, Scoring(), prepare(options)))
    differs = [name for name in given[0] if given[0][name] != given[1][name]]
    assert differs == ["the scenarios of the routes"]


def test_an_unknown_type_names_the_known_types(tmp_path: Path) -> None:
    path = route_file(tmp_path, at("x_1", "PedestrianCrosing", 20.0))
    (description,) = read_routes(path)
    with pytest.raises(
        ScenarioError, match=r"line 4: 'x_1' .* did you mean 'PedestrianCrossing'\? there are .*Dooring"
    ):
        scenarios_on(description)


def test_the_packaged_route_has_scenarios_that_all_have_their_place() -> None:
    text = LINDEN.read_text(encoding="utf-8")
    town = carla.Map("Linden", text)
    (description,) = read_routes(PACKAGED)
    from basu.routing import plan  # noqa: PLC0415 - only here

    route = plan(town, description)
    laid = [place_scenario(waiting, route, town, own=False) for waiting in scenarios_on(description)]
    assert 5 <= len(laid) <= 8
    begins = [each.scenario.place.trigger_s_m for each in laid]
    assert begins == sorted(begins)


class Weather:
    """Of a world, and its lights."""

    def __init__(self) -> None:
        self.now = carla.WeatherParameters(cloudiness=10.0, sun_altitude_angle=45.0)
        self.light = SimpleNamespace(calls=[])
        for name in ("freeze", "set_state", "reset_group"):
            setattr(self.light, name, lambda *given, name=name: self.light.calls.append((name, *given)))

    def get_weather(self) -> carla.WeatherParameters:
        return carla.WeatherParameters(**{name: getattr(self.now, name) for name in ("cloudiness", "wetness")}, **SUN)

    def set_weather(self, weather: carla.WeatherParameters) -> None:
        self.now = weather

    def get_traffic_light_from_opendrive_id(self, name: str) -> Any:
        return self.light if name == "7" else None


SUN = {"sun_altitude_angle": 45.0}
FRAMES_UNDER_WAY = 20  # that a client may still show as they were


def test_an_actor_that_leaves_first_takes_no_weather_from_the_others() -> None:
    from basu.managers.stage.environment import SharedWorld  # noqa: PLC0415 - only here

    world = Weather()
    shared = SharedWorld(world)
    shared.ask_weather("rain", {"wetness": 60.0})
    shared.ask_weather("cloud", {"cloudiness": 90.0})
    shared.give_back("rain")
    assert (world.now.wetness, world.now.cloudiness) == (0.0, 90.0)
    world.now = shared.changes.weather = carla.WeatherParameters(cloudiness=30.0, **SUN)  # the route's own changes
    shared.keep_up()
    assert world.now.cloudiness == 90.0
    shared.give_back("cloud")
    assert (world.now.wetness, world.now.cloudiness) == (0.0, 30.0)


def test_lights_go_on_when_the_last_scenario_that_holds_one_is_over() -> None:
    from basu.managers.stage.environment import SharedWorld  # noqa: PLC0415 - only here

    world = Weather()
    shared = SharedWorld(world)
    shared.ask_light("first", "7", "Red")
    shared.ask_light("second", "7", "Green")
    red, green = carla.TrafficLightState.Red, carla.TrafficLightState.Green
    assert world.light.calls == [("freeze", True), ("set_state", red), ("set_state", green)]
    shared.give_back("second")
    assert world.light.calls[-1] == ("set_state", red)
    shared.give_back("first")
    assert world.light.calls[-2:] == [("reset_group",), ("freeze", False)]
    with pytest.raises(ScenarioError, match="no traffic light with the OpenDRIVE signal '8'"):
        shared.ask_light("first", "8", "Red")


def test_what_was_not_reached_is_reported_as_such() -> None:
    laid = place_scenario(waiting_at(12.0), WAY, TOWN, own=False)
    stage: Any = SimpleNamespace(route=laid.way, roles={}, types={})
    playing = Playing(laid.planned, laid.scenario, laid.composed, stage)
    (row,) = results_of([playing], None, Outcome(Status.AGENT_CRASHED, "the agent raised KeyError"))
    assert (row["reached"], row["verdict"]) == (False, None)
    assert row["message"] == "it waits at 10 m of the route, and the run ended before: the agent raised KeyError"
    schema = read_schema(RESULT_SCHEMA)
    assert list(mistakes(row, {**schema["$defs"]["scenario"], "$defs": schema["$defs"]})) == []
    text = "\n".join(scenario_lines([row]))
    assert "0 of 0 passed, 0 not exercised; 0 of 1 reached" in text
    assert "not reached" in text


CLASSES = '''
"""Scenarios of a user's, beside the route file."""

from basu.scenarios.actions import Action, InTurn, SetFriction, SetWeather, Wait, WalkAlong
from basu.scenarios.criteria import NoCollision
from basu.scenarios.nhtsa import Group
from basu.scenarios.paths import Path
from basu.scenarios.scenario import Scenario
from basu.scenarios.stage import ActorSpec
from basu.scenarios.triggers import EgoPasses


class Crosser(Scenario):
    """A pedestrian crosses far ahead, in the rain."""

    group = Group.PEDESTRIAN
    needs_m = 45.0

    def actors(self):
        return [ActorSpec("walker", "walker.pedestrian.0001", self.place.at(40.0, 4.0, -90.0))]

    def setup(self):
        return InTurn(SetWeather(wetness=80.0), SetFriction(self.place.at(40.0), 5.0, 0.6))

    def trigger(self):
        return Wait(0.5)

    def conflict(self):
        return WalkAlong("walker", Path.straight(self.place.at(40.0, 4.0, -90.0), 9.0), 1.6)

    def criteria(self):
        return [NoCollision()]


class Dark(Scenario):
    """What the next two share."""

    group = Group.ANIMAL
    needs_m = 30.0

    def actors(self):
        return [ActorSpec("cone", "static.prop.trafficcone01", self.place.at(20.0, 4.0))]

    def setup(self):
        return SetWeather(cloudiness=77.0)

    def trigger(self):
        return Wait(0.5)

    def conflict(self):
        return Wait(0.5)

    def criteria(self):
        return [NoCollision()]


class Stumbles(Dark):
    """An action that raises, while it is dark."""

    class Stumble(Action):
        def act(self):
            raise ZeroDivisionError("stumbled")

    def conflict(self):
        return self.Stumble("stumble")


class Dozes(Dark):
    """A trigger that never comes true."""

    def trigger(self):
        return EgoPasses(1000.0)
'''


@pytest.fixture
def simulator() -> Iterator[RunningServer]:
    """A simulator of its own, since the actors before and afterwards are compared."""
    with running_server() as running:
        yield running


def world_of(simulator: RunningServer) -> carla.World:
    client = carla.Client("127.0.0.1", simulator.port)
    client.set_timeout(20.0)
    return client.get_world()


def seen(world: carla.World) -> set[tuple[int, str]]:
    """The actors, the weather, and the frozen lights."""
    actors = world.get_actors()
    lights = actors.filter("traffic.traffic_light*")
    return {
        *((actor.id, actor.type_id) for actor in actors),
        *((light.id, "frozen") for light in lights if light.is_frozen()),
        (0, str(world.get_weather())),
    }


def driven(simulator: RunningServer, folder: Path, path: Path, *words: str) -> tuple[int, dict[str, Any]]:
    """A run and its result."""
    where = ["--host", "127.0.0.1", "--port", str(simulator.port), "--output", str(folder / "runs")]
    code = main(["run", "basic", "--in-process", "--routes", str(path), *where, *words])
    result: dict[str, Any] = json.loads((folder / "runs" / "latest" / "result.json").read_text(encoding="utf-8"))
    return code, result


def test_a_run_meets_its_scenarios_and_leaves_the_world_as_it_was(
    simulator: RunningServer, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "way.py").write_text(CLASSES, encoding="utf-8")
    waiting = [("rain_1", "Crosser", 20.0), ("stumbles_1", "Stumbles", 30.0), ("dozes_1", "Dozes", 70.0)]
    path = route_file(tmp_path, "\n".join(at(*each) for each in waiting))
    world_of(simulator).set_weather(carla.WeatherParameters.ClearNoon)
    before = seen(world_of(simulator))
    code, result = driven(simulator, tmp_path, path, "--weather", "ClearNoon")
    world = world_of(simulator)
    for _ in range(FRAMES_UNDER_WAY):
        if seen(world) == before:
            break
        world.wait_for_tick(10.0)
    after = seen(world)
    assert (after - before, before - after) == (set(), set())
    assert code == 0  # the drive is the drive; each scenario has a verdict of its own
    assert list(mistakes(result, read_schema(RESULT_SCHEMA))) == []
    rain, stumbles, dozes = result["scenarios"]
    assert rain["verdict"] == "SUCCESS"
    assert rain["phases_s"]["trigger"] <= rain["phases_s"]["conflict"] < rain["ended_s"]
    assert stumbles["verdict"] == dozes["verdict"] == "SETUP_FAULT"
    assert "ZeroDivisionError: stumbled" in stumbles["message"]
    assert "way.py" in stumbles["message"]
    assert rain["began_s"] < stumbles["began_s"] < rain["ended_s"]  # they overlap
    assert "it never triggered" in dozes["message"]
    said = capsys.readouterr().out
    assert "1 of 1 passed, 0 not exercised; 3 of 3 reached" in said
