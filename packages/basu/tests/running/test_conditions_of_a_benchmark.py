"""Claims about agents that choose their conditions: the benchmark's hold, and an own route is never official."""

import io
import json
import tarfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.loader import LoadedAgent
from basu.agents.process.remote_agent import AgentInProcess, find_agent
from basu.campaigns.player import PlayerSettings, _after, _Player
from basu.cli import main
from basu.conditions import SimulatorSpec
from basu.episode import Towns
from basu.errors import AgentCrashedError
from basu.jobs.job import After
from basu.managers.agents_manager import AgentsManager, ignored_wishes
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.outcome import Status
from basu.running.one_run import Session, next_agents
from basu.running.preparation import agents_fault, new_agents, prepare
from basu.scenarios.cases import open_library
from basu.simulator import Simulator, simulator_for
from servers import RunningServer

AGENT = """
class Chooser(AutonomousAgent):
    def setup(self): self.steps = 0
    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > 5:
            raise ValueError("enough")
        return carla.VehicleControl(brake=1.0)
    def config(self):
        return CONFIG
    def get_initial_route_locations(self):
        return POINTS
"""


def chooser(folder: Path, config: str = "{}", points: str = "None") -> Path:
    path = folder / "chooser.py"
    path.write_text(AGENT.replace("CONFIG", config).replace("POINTS", points))
    return path


@pytest.fixture
def at_server(simulator: RunningServer) -> Iterator[Simulator]:
    with simulator_for(SimulatorSpec(host="127.0.0.1", port=simulator.port)) as found:
        yield found


@pytest.fixture
def run(simulator: RunningServer, tmp_path: Path) -> Callable[..., dict[str, Any]]:
    """``basu run`` in this process at the shared simulator; the result."""

    def at(agent: Path, *options: str) -> dict[str, Any]:
        output = tmp_path / "runs"
        address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
        main(["run", str(agent), *address, "--output", str(output), *options])
        document: dict[str, Any] = json.loads((output / "latest" / "result.json").read_text())
        return document

    return at


def points_of(route_file: Path, count: int) -> str:
    (route,) = prepare(RunOptions(agent="standing", routes=str(route_file))).jobs
    return str([(at.x_m, at.y_m, at.z_m) for at in route.description.points[:count]])


def test_a_campaign_ignores_what_an_agent_asks_of_route_vehicle_and_weather(
    at_server: Simulator, tmp_path: Path, route_file: Path
) -> None:
    """Two points 10 m apart were a COMPLETED run under the official route's name; wrong wishes were excuses."""
    wishes = "{'vehicle': 'vehicle.none', 'weather': 'Foggy', 'routes': 'none.xml', 'sumo': 'nowhere'}"
    path = chooser(tmp_path, wishes, "[(5000, 5000, 0), (5010, 5000, 0)]")
    settings = PlayerSettings(
        agents=(str(path),),
        scoring=Scoring(),
        vehicle=None,
        open=False,
        step_limit_s=10.0,
        agent_memory_gb=None,
        agent_writes=(),
        scenario_files=(),
        metric_files=(),
        sample=0.0,
        scratch=None,
    )
    player = _Player(settings, {str(path): find_agent(str(path))}, open_library(()), at_server, tmp_path)
    job = {"id": "0" * 16, "kind": "route", "agent": str(path), "track": None, "file": str(route_file)}
    others = {"identity": "piece", "seed": 0, "weather": "as given", "scenarios": False, "bar": 0.0}
    traffic = {"vehicles": 0, "walkers": 0, "density_per_km": None}
    done = player.play({**job, **others, **traffic}).value
    assert (done.result.outcome.status, done.result.success.passed) == (Status.AGENT_CRASHED, False)
    with tarfile.open(fileobj=io.BytesIO(done.packed)) as tar:
        result, config = (json.load(tar.extractfile(name)) for name in ("result.json", "config.json"))  # type: ignore[arg-type]
    meta = result["meta"]
    assert (meta["route"], meta["own_route"]) == ("piece", False)
    assert (meta["vehicle"], meta["weather"]) == ("vehicle.easymile.ez10", "ClearNoon")
    (note,) = (each for each in config["notes"] if "ignored" in each)
    assert "config() of Chooser asks for routes 'none.xml', sumo 'nowhere', vehicle 'vehicle.none'" in note


def test_a_case_and_a_plan_say_that_wishes_are_ignored(tmp_path: Path) -> None:
    found = find_agent(str(chooser(tmp_path, "{'weather': 'HardRainNoon', 'track': 'objects'}")))
    assert "asks for weather 'HardRainNoon'; these are the benchmark's here" in ignored_wishes(found)
    agents = new_agents(found, RunOptions(), 0, has_conditions=False)
    assert (agents.config.weather, agents.config.track) == ("ClearNoon", "objects")
    assert ignored_wishes(find_agent(str(chooser(tmp_path, "{'sensors': 'config/sensors.json'}")))) == ""


def test_an_agent_that_answers_wrongly_in_chosen_drives_fails_in_them() -> None:
    class Chooser(AutonomousAgent):
        def setup(self) -> None: ...
        def run_step(self, sensor_data: Any) -> Any: ...
        def config(self) -> Any:
            return {"nonsense": "x"}

    loaded = LoadedAgent(Chooser, "Chooser", Path("chooser.py"))
    with pytest.raises(AgentCrashedError, match="nonsense"):
        prepare(RunOptions(), loaded, has_conditions=False)
    with pytest.raises(AgentCrashedError, match="nonsense"), agents_fault(loaded):
        AgentsManager(loaded, step_limit_s=1.0, routes=None)


@pytest.mark.parametrize("by", ["config", "points"])
def test_a_route_of_the_agents_own_says_so_and_is_not_comparable(
    run: Callable[..., dict[str, Any]], tmp_path: Path, route_file: Path, capsys: pytest.CaptureFixture[str], by: str
) -> None:
    if by == "config":
        agent, options = chooser(tmp_path, f"{{'routes': {str(route_file)!r}}}"), []
    else:
        agent, options = chooser(tmp_path, "{}", points_of(route_file, 2)), ["--routes", str(route_file)]
    result = run(agent, *options)
    assert (result["meta"]["route"], result["meta"]["own_route"]) == ("piece-own", True)
    latest = (tmp_path / "runs" / "latest").resolve()
    assert latest.name.endswith("-own")
    assert "piece-own (the agent's own)" in (latest / "result.txt").read_text()
    assert "NOT COMPARABLE: the route was the agent's own, and not the benchmark's" in capsys.readouterr().out


def test_a_file_beside_the_agent_takes_no_official_routes_place(tmp_path: Path, route_file: Path) -> None:
    (tmp_path / "routes").mkdir()
    route_file.rename(tmp_path / "routes" / "linden_short.xml")
    agent = chooser(tmp_path, "{'routes': 'routes/linden_short.xml'}")
    by_user = prepare(RunOptions(agent=str(agent), routes="routes/linden_short.xml")).jobs[0].description
    assert not by_user.is_own
    assert by_user.id != "piece"
    by_agent = prepare(RunOptions(agent=str(agent))).jobs[0]
    assert (by_agent.description.id, by_agent.label) == ("piece-own", "linden_short-own")


def test_an_agent_that_fails_before_a_drive_of_a_series_has_had_its_run(
    run: Callable[..., dict[str, Any]], tmp_path: Path, route_file: Path
) -> None:
    """A route off the road ended the series, and so did a death in a chosen run: neither was counted."""
    agent = chooser(tmp_path, "{}", "[(5000, 5000, 0), (5010, 5000, 0)]")
    result = run(agent, "--series", "s", "--repetitions", "2", "--routes", str(route_file))
    assert (result["status"], result["passed"]) == ("AgentCrashed", False)
    assert "get_initial_route_locations() gives no route" in result["message"]
    series = json.loads((tmp_path / "runs" / "s" / "series.json").read_text())
    assert series["totals"]["passed"] == {"passed": 0, "failed": 2, "not judged": 0}


def test_later_runs_keep_the_conditions_of_the_first(at_server: Simulator, tmp_path: Path, route_file: Path) -> None:
    agent = chooser(tmp_path, "{'vehicle': str(__import__('time').time_ns())}")
    options = RunOptions(agent=str(agent), routes=str(route_file), repetitions=2)
    plan = prepare(options)
    session = Session(options, Scoring(), plan, at_server, Towns(at_server))
    assert isinstance(plan.loaded, AgentInProcess)
    assert next_agents(session, plan.jobs[1]).config == plan.agents.config


def test_a_campaign_gives_an_unsafe_drive_no_second_try() -> None:
    assert _after(Status.SIMULATOR_FAILED, success=False) is After.FRESH
    assert _after(Status.SIMULATOR_FAILED, success=None) is After.AGAIN
    assert _after(Status.COMPLETED, success=True) is After.GO_ON
