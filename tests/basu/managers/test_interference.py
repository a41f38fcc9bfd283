"""Claims about cheats in later steps: weather, physics, lights, other actors, and controls from elsewhere.

The drivers are real and the simulator is live; the tables of single changes need neither.
"""

import json
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu.cli import main
from basu.errors import AgentCrashedError
from basu.managers.base_manager import WorldChanges
from basu.managers.conduct import Conduct
from basu.managers.interference import LightsCheck, OthersCheck, is_same_control
from basu.records.history.files import read_history
from basu.running import runner
from basu.running.scenario_runs import player
from basu.simulator import Simulator, connect
from cheating_agent import cheating_agent
from servers import RunningServer

NIGHT = "self.world.set_weather(carla.WeatherParameters.HardRainNight)"
GRIP = (
    "p = self.vehicle.get_physics_control(); w = list(p.wheels); [setattr(x, 'tire_friction', 9.0) for x in w]; "
    "p.wheels = w; self.vehicle.apply_physics_control(p)"
)
BRAKE = "self.vehicle.set_target_velocity(carla.Vector3D())"
LIGHTS = "self.world.get_actors().filter('traffic.traffic_light')"
DEAF = "[s.destroy() for s in self.world.get_actors().filter('sensor.other.collision')]"
THREAD = """def floor_it(self):
        while True:
            self.vehicle.apply_control(carla.VehicleControl(throttle=1.0))
            time.sleep(0.0002)
"""
START = "threading.Thread(target=self.floor_it, daemon=True).start()"
ALONE = [
    pytest.param("pass", "> 20", NIGHT, "", "changed the weather's", id="weather"),
    pytest.param("pass", "> 20", GRIP, "", "tire_friction", id="grip"),
    pytest.param("pass", "== 60", BRAKE, "", "and touched nothing", id="stops at once"),
    pytest.param("pass", "> 20", DEAF, "", "sensor.other.collision out of the world", id="no collision sensor"),
    pytest.param(
        "pass", "== 20", f"[l.set_state(l.get_state().Green) for l in {LIGHTS}]", "", "red became green", id="green"
    ),
    pytest.param("pass", "== 20", f"{LIGHTS}[0].freeze(True)", "", "its clock was stopped", id="frozen lights"),
    pytest.param(
        "pass", "== 20", f"[l.set_green_time(99.0) for l in {LIGHTS}]", "", "times of its colours", id="long green"
    ),
    pytest.param(
        "pass", "== 20", "self.world.reset_all_traffic_lights()", "", "was begun anew", id="lights begin anew"
    ),
]
AMONG_OTHERS = {
    "destroys": ("self.others()[0].destroy()", "out of the world"),
    "moves": ("self.others()[0].set_transform(self.route.waypoints[-1].transform)", "moved the actor"),
    "controls": ("self.others()[0].apply_control(carla.VehicleControl(throttle=1.0, steer=1.0))", "gave the actor"),
    "ghost": ("self.vehicle.set_collisions(False)", "without a contact"),
}


@pytest.fixture(scope="module")
def client(simulator: RunningServer) -> carla.Client:
    """One client for all drives."""
    return connect("127.0.0.1", simulator.port, 20.0)


Ours = Callable[[object], AbstractContextManager[Simulator]]


@pytest.fixture(scope="module")
def ours(simulator: RunningServer, client: carla.Client) -> Ours:
    """Return a ``simulator_for`` with which a command takes the session's server for one of its own: it starts none."""
    found = Simulator(client, ("127.0.0.1", simulator.port), own=True, why_gone=lambda: None, ended=lambda: False)
    return lambda _: nullcontext(found)


@pytest.fixture
def as_own(ours: Ours, client: carla.Client, monkeypatch: pytest.MonkeyPatch) -> Iterator[carla.Client]:
    """A client of the server that runs take for their own; its lights are as before afterwards."""
    monkeypatch.setattr(runner, "simulator_for", ours)
    world = client.get_world()
    lights = [(light, light.get_green_time()) for light in world.get_actors().filter("traffic.traffic_light")]
    yield client
    for light, green_s in lights:
        light.set_green_time(green_s)
    world.freeze_all_traffic_lights(False)
    world.reset_all_traffic_lights()


@pytest.fixture
def to_a_light(as_own: carla.Client, tmp_path: Path) -> Path:
    """A route that passes a traffic light, red for the whole drive there."""
    light = as_own.get_world().get_actors().filter("traffic.traffic_light")[0]
    stop = light.get_stop_waypoints()[0]
    places = [stop.previous(60.0)[0], stop, stop.next(25.0)[0]]
    lines = [f'<position x="{p.transform.location.x}" y="{p.transform.location.y}" z="0.0"/>' for p in places]
    path = tmp_path / "to_a_light.xml"
    head = '<routes><route id="light" town="Linden"><waypoints>'
    path.write_text(head + "\n".join(lines) + "</waypoints></route></routes>", encoding="utf-8")
    return path


@pytest.mark.parametrize(("at_setup", "when", "deed", "more", "sentence"), ALONE)
def test_a_cheat_in_a_later_step_has_failed(
    to_a_light: Path, tmp_path: Path, *, at_setup: str, when: str, deed: str, more: str, sentence: str
) -> None:
    agent = cheating_agent(tmp_path, "cheat", at_setup=at_setup, when=when, deed=deed, more=more)
    assert main(["run", str(agent), "--routes", str(to_a_light), "--output", str(tmp_path / "runs")]) == 1
    result = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text())
    assert (result["status"], result["fault"]) == ("AgentCrashed", "agent"), result["message"]
    assert sentence in result["message"]


def test_a_control_from_a_thread_is_a_cheat_or_has_no_effect(to_a_light: Path, tmp_path: Path) -> None:
    """The benchmark's own control is the last before most steps; where it is not, the run ends."""
    agent = cheating_agent(tmp_path, "cheat", at_setup=START, when="> 999", deed="pass", more=THREAD)
    honest = cheating_agent(tmp_path, "honest", when="> 999", deed="pass")
    options = ["--routes", str(to_a_light), "--output", str(tmp_path / "runs")]
    assert main(["run", str(honest), *options]) == 0
    alone = read_history(tmp_path / "runs" / "latest")
    code = main(["run", str(agent), *options])
    result = json.loads((tmp_path / "runs" / "latest" / "result.json").read_text())
    if code == 1:
        assert "instead of throttle" in result["message"]
    else:
        assert (code, read_history(tmp_path / "runs" / "latest").frames.tolist()) == (0, alone.frames.tolist())


def test_a_step_with_another_control_has_a_sentence() -> None:
    given, had = carla.VehicleControl(brake=1.0), carla.VehicleControl(throttle=1.0)
    run: Any = SimpleNamespace(changes=WorldChanges(control=given), vehicle=SimpleNamespace(get_control=lambda: had))
    frame: Any = SimpleNamespace(server_frame=7)
    with pytest.raises(AgentCrashedError, match=r"had throttle 1\.00, .* instead of throttle 0\.00, .* brake 1\.00 in"):
        Conduct("Cheat")._check_control(frame, run)


@pytest.fixture(scope="module")
def among_others(ours: Ours, tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    """What became of cheats that touch the other actors of a case."""
    folder = tmp_path_factory.mktemp("cheats")
    agents = [str(cheating_agent(folder, name, deed=deed)) for name, (deed, _) in AMONG_OTHERS.items()]
    options = [word for agent in agents for word in ("--agent", agent)]
    case = "follow_leading_vehicle_1"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(player, "simulator_for", ours)
        main(["scenario", "run", case, *options, "--output", str(folder / "runs"), "--workers", "1"])
    found = {}
    for path in (folder / "runs" / "latest").glob("*/*/result.json"):
        found[path.parent.parent.name] = json.loads(path.read_text(encoding="utf-8"))
    return found


@pytest.mark.parametrize("name", AMONG_OTHERS)
def test_a_cheat_among_others_has_failed(among_others: dict[str, dict[str, Any]], name: str) -> None:
    (result,) = [result for key, result in among_others.items() if name in key]
    assert result["status"] == "AgentCrashed", result["message"]
    assert AMONG_OTHERS[name][1] in result["message"]
    assert result["verdict"] == "AGENT_FAULT"


class Light:
    """A light of a group of two, which take turns as CARLA's controllers do: green 1 s, yellow 0.5 s, red 0.2 s."""

    def __init__(self, key: int, group: "list[Light]") -> None:
        self.id, self.group, self.frozen = key, group, False
        self.colour, self.elapsed_s, self.times_s = carla.TrafficLightState.Red, 0.0, [1.0, 0.5, 0.2]
        group.append(self)

    def get_group_traffic_lights(self) -> "list[Light]":
        return self.group

    def get_state(self) -> carla.TrafficLightState:
        return self.colour

    def get_elapsed_time(self) -> float:
        return self.elapsed_s

    def is_frozen(self) -> bool:
        return self.frozen

    def get_green_time(self) -> float:
        return self.times_s[0]

    def get_yellow_time(self) -> float:
        return self.times_s[1]

    def get_red_time(self) -> float:
        return self.times_s[2]


class Crossing:
    """The group, its clock, and the check that looks at it."""

    def __init__(self) -> None:
        self.group: list[Light] = []
        self.lights = [Light(7, self.group), Light(8, self.group)]
        self.lights[0].colour = carla.TrafficLightState.Green
        self.turn = 0
        self.changes = WorldChanges()
        world: Any = SimpleNamespace(get_traffic_light_from_opendrive_id=lambda _: self.lights[0])
        route: Any = SimpleNamespace(controls=[SimpleNamespace(landmark_id="7")])
        self.check = LightsCheck(world, route, self.changes, 0.05)

    def step(self) -> str | None:
        states = carla.TrafficLightState
        light = self.lights[self.turn]
        if not light.frozen:
            light.elapsed_s += 0.05
            stage = [states.Green, states.Yellow, states.Red].index(light.colour)
            if light.elapsed_s > light.times_s[stage] + 1e-6:
                light.elapsed_s = 0.0
                if stage == 2:
                    self.turn = 1 - self.turn
                    self.lights[self.turn].colour = states.Green
                else:
                    light.colour = [states.Yellow, states.Red][stage]
        return self.check.fault()


def test_lights_that_take_turns_are_left_alone() -> None:
    crossing = Crossing()
    assert [crossing.step() for _ in range(300)] == [None] * 300


def stepped(steps: int) -> Crossing:
    crossing = Crossing()
    for _ in range(steps):
        assert crossing.step() is None
    return crossing


@pytest.mark.parametrize("after", range(1, 75))
def test_a_light_that_turns_green_before_its_turn_was_changed(after: int) -> None:
    crossing, green = stepped(after), carla.TrafficLightState.Green
    waiting = next(number for number, light in enumerate(crossing.lights) if light.colour != green)
    crossing.lights[waiting].colour = green
    found = [crossing.step() for _ in range(2)]
    begins_anyway = stepped(after + 1).lights[waiting].colour == green
    assert any(found) or begins_anyway


def test_a_scenarios_own_change_of_lights_is_no_cheat() -> None:
    crossing = Crossing()
    crossing.step()
    crossing.changes.lights += 1
    crossing.lights[1].colour = carla.TrafficLightState.Green
    assert crossing.step() is None
    crossing.lights[0].frozen = True
    assert crossing.step() == "changed the traffic light 7: its clock was stopped"


def at(place: tuple[float, float] | None) -> Any:
    """An actor of a snapshot at a place."""
    if place is None:
        return None
    pose = carla.Transform(carla.Location(*place))
    return SimpleNamespace(get_transform=lambda: pose)


def others_seen(rows: list[dict[int, tuple[float, float]]], **changes: Any) -> list[str | None]:
    """The faults frame by frame of others at places (x, y) by id, all of them standing cars."""
    kept = WorldChanges(**changes)
    neighbours: Any = SimpleNamespace(
        met={2: "vehicle.a", 3: "vehicle.b"},
        near=lambda frame: [(0, key, x, y, 0.0, 0.0, 0.0, 0.0) for key, (x, y) in frame.rows.items() if x < 60.0],
    )
    check = OthersCheck(neighbours, kept, 0.05)
    found = []
    for places in rows:
        frame: Any = SimpleNamespace(
            rows=places, snapshot=SimpleNamespace(find=lambda key, now=places: at(now.get(key)))
        )
        found.append(check.fault(frame))
    return found


def test_others_that_stand_are_left_alone_and_one_that_vanishes_or_jumps_is_named() -> None:
    assert others_seen([{2: (0.0, 0.0)}] * 3) == [None] * 3
    assert others_seen([{2: (0.0, 0.0)}, {}])[1] == "took the actor 2 (vehicle.a) out of the world"
    assert others_seen([{2: (0.0, 0.0)}, {2: (5.0, 0.0)}])[1] == "moved the actor 2 (vehicle.a) by 5.0 m"
    assert others_seen([{2: (0.0, 0.0)}, {2: (300.0, 0.0)}])[1] == "moved the actor 2 (vehicle.a) by 300.0 m"
    assert any(others_seen([{2: (0.2 * n, 0.0)} for n in range(60)]))


def test_what_the_benchmark_removes_or_places_is_no_cheat() -> None:
    assert others_seen([{2: (0.0, 0.0)}, {}], removed={2}) == [None, None]
    assert others_seen([{}, {2: (0.0, 0.0)}, {2: (5.0, 0.0)}], placed={2})[1] is None


def test_controls_are_compared_but_for_their_rounding() -> None:
    given = carla.VehicleControl(throttle=0.1, steer=-0.7, brake=0.3)
    assert is_same_control(given, carla.VehicleControl(throttle=0.10000001, steer=-0.7, brake=0.3, gear=3))
    assert not is_same_control(given, carla.VehicleControl(throttle=0.1, steer=-0.7, brake=0.3, reverse=True))
