"""Claims about ``basu service`` in the simulator: the same bytes again, an agent that dies, cheats, and bad input."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from basu.cli import main
from basu.records.history.files import read_history
from basu_service.document import read_service
from servers import RunningServer

STEP_S = 0.05
EXAMPLE = Path(__file__).parents[3] / "examples" / "hidden_person_agent.py"
Services = Callable[..., tuple[int, Path]]
DIES = """
class Dies(AutonomousAgent):
    def setup(self):
        self.steps = 0

    def run_step(self, sensor_data):
        self.steps += 1
        if self.steps > 60:
            raise ValueError("enough")
        return carla.VehicleControl(brake=1.0)

    def config(self):
        return {}
"""
LEAVES = """
class Leaves(AutonomousAgent):
    \"\"\"Goes at once with open doors, straight on.\"\"\"

    def setup(self):
        pass

    def run_step(self, sensor_data):
        self.vehicle.open_door(carla.VehicleDoor.All)
        return carla.VehicleControl(throttle=0.5)

    def config(self):
        return {}
"""
PROBE = """
from basu.agents.builtin.cooperative import CooperativeAgent

class Probe(CooperativeAgent):
    def run_step(self, sensor_data):
        control = super().run_step(sensor_data)
        if self._ticks == 470:
            heard = sorted(stop for stop, _ in self.headways._others.values())
            open(f"{FOLDER}/{self.route.length_m:.0f}.txt", "w").write(" ".join(heard))
        return control
"""
BUSY = {
    "schema_version": 1,
    "stops": {"S1": {"rates": [{"from": "06:00", "to": "20:00", "per_hour": 1500}], "to": {"S4": 1}}},
    "patience_min": 20,
}


@pytest.fixture
def services(simulator: RunningServer, tmp_path: Path) -> Services:
    """``basu service run`` at the shared simulator; the exit code and the folder."""

    def run(agent: object, *options: object, name: str = "runs") -> tuple[int, Path]:
        address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
        code = main(["service", "run", str(agent), *address, "--output", str(tmp_path / name), *map(str, options)])
        return code, tmp_path / name / "latest"

    return run


@pytest.fixture
def busy(tmp_path: Path) -> Path:
    """A demand with a person every few seconds at the first stop."""
    path = tmp_path / "busy.json"
    path.write_text(json.dumps(BUSY), encoding="utf-8")
    return path


def saved(folder: Path, name: str, text: str) -> Path:
    path = folder / f"{name}.py"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.slow
def test_a_shuttle_waits_until_all_have_boarded_and_two_services_have_the_same_bytes(
    services: Services, busy: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--minutes", 0.45, "--demand", busy, "--seed", 4, "--no-holding"]
    (_, first), (_, again) = (
        services("cooperative", *options, name="one"),
        services("cooperative", *options, name="two"),
    )
    for name in ("service.json", "service.html", "history.parquet", "shuttle_2/history.parquet"):
        assert (first / name).read_bytes() == (again / name).read_bytes(), name
    document = read_service(first)
    call = document["calls"][0]
    assert call["boarded"] >= 4
    assert call["departure_s"] is None or call["departure_s"] - call["arrival_s"] > 2.5 * call["boarded"]
    held = document["vehicles"][0]
    assert held["calls"] == 1
    part = document["persons"]
    assert part["came"] == part["carried"] + part["riding"] + part["stranded"] + part["waiting"] + part["gave_up"]
    assert "standing passengers lose balance" in capsys.readouterr().out


@pytest.mark.slow
def test_an_agent_that_dies_is_judged_alone_and_the_service_goes_on(
    services: Services, tmp_path: Path, busy: Path
) -> None:
    dies = saved(tmp_path, "dies", DIES)
    code, folder = services(dies, "--beside", "basic", "--minutes", 0.3, "--demand", busy)
    assert code == 1
    document = read_service(folder)
    assert [vehicle["status"] for vehicle in document["vehicles"]] == ["AgentCrashed", "Stopped"]
    assert document["lasts_s"] == pytest.approx(18.0, abs=0.1)
    assert document["vehicles"][1]["driven_m"] > 10.0
    assert document["persons"]["stranded"] == document["vehicles"][0]["boarded"]
    assert any("vehicle 1 ended before the service" in why for why in document["reasons"])
    assert (folder / "shuttle_2" / "result.json").exists()


@pytest.mark.slow
def test_an_agent_that_leaves_with_open_doors_is_held_and_no_person_boards_while_it_moves(
    services: Services, tmp_path: Path, busy: Path
) -> None:
    leaves = saved(tmp_path, "leaves", LEAVES)
    code, folder = services(leaves, "--beside", "basic", "--minutes", 0.5, "--demand", busy, "--no-holding")
    document = read_service(folder)
    calls = [call for call in document["calls"] if call["vehicle"] == 1]
    moved_s = document["lasts_s"] if not calls or calls[0]["departure_s"] is None else calls[0]["departure_s"]
    boarded_s = [each["boarded_s"] for each in document["journeys"] if each["vehicle"] == 1]
    assert all(each is not None and each <= moved_s for each in boarded_s)
    assert code == 1
    assert not document["passed"]


@pytest.mark.slow
def test_a_cooperative_shuttle_hears_when_the_other_one_left_its_stop(services: Services, tmp_path: Path) -> None:
    told = tmp_path / "told"
    told.mkdir()
    probe = saved(tmp_path, "probe", f"FOLDER = {str(told)!r}\n{PROBE}")
    services(probe, "--minutes", 0.4, "--no-holding", "--apart", 1, "--agent-writes", told)
    ahead, behind = sorted(told.iterdir(), key=lambda path: float(path.stem))  # the first one has the longer way
    assert ahead.read_text(encoding="utf-8") == "S1"
    assert behind.read_text(encoding="utf-8") == ""


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--beside", "hero=basic"], "two shuttles have the role 'hero'"),
        (["--routes", "routes/linden_short.xml"], "a service needs a round"),
        (["--minutes", "0"], "a service lasts more than 0"),
        (["--demand", "nowhere.json"], "nowhere.json"),
        (["--timetable", "hasty.json"], "cannot be driven"),
        (["--apart", "20"], "cannot begin 20 min apart"),
        (["--apart", "0.2"], "begin at the same place"),
    ],
)
def test_bad_input_is_a_sentence_and_leaves_nothing(
    services: Services,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    says: str,
) -> None:
    source = Path(__file__).parents[2] / "basu" / "src" / "basu" / "routes" / "linden_leap.timetable.json"
    hasty: dict[str, Any] = json.loads(source.read_text(encoding="utf-8"))
    hasty["calls"][1] |= {"arrival": "01:00", "departure": "01:20"}
    (tmp_path / "hasty.json").write_text(json.dumps(hasty), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    code, folder = services("basic", *options)
    assert code == 2
    assert says in capsys.readouterr().err
    assert not folder.exists()


@pytest.mark.slow
def test_persons_that_wait_are_walkers_beside_the_stop_until_they_board(services: Services, busy: Path) -> None:
    options = ["--minutes", 0.45, "--demand", busy, "--seed", 4, "--no-holding"]
    (_, plain), (_, first), (_, again) = (
        services("basic", *options, *more, name=name)
        for name, more in (("plain", ()), ("one", ("--bodies",)), ("two", ("--bodies",)))
    )
    for name in ("service.json", "history.parquet", "shuttle_2/history.parquet"):
        assert (first / name).read_bytes() == (again / name).read_bytes(), name
    document = read_service(first)
    came_s = [each["came_s"] for each in document["journeys"]]
    assert came_s == [each["came_s"] for each in read_service(plain)["journeys"]]  # the same persons
    walkers, history = seen_walkers(first), read_history(first)
    assert seen_walkers(plain) == {}
    boarded_s = [each["boarded_s"] for each in document["journeys"] if each["boarded_s"] is not None]
    assert len(walkers) >= 3
    stop = next(each for each in history.facts.route.stops if each.id == "S1")
    for rows in walkers.values():
        places = np.array([(row["x_m"], row["y_m"]) for row in rows])
        assert np.ptp(places, axis=0).max() < 0.5  # it stands
        away_m = np.hypot(places[0, 0] - stop.x_m, places[0, 1] - stop.y_m)
        assert 1.5 < away_m < 25.0
    ends_s = [STEP_S * float(rows[-1]["tick"]) for rows in walkers.values()]
    gone_s = [end_s for end_s in ends_s if end_s < document["lasts_s"] - 1.0]
    assert len(gone_s) >= 2
    for end_s in gone_s:  # the queue is read every half second
        assert min(abs(end_s - each) for each in boarded_s) < 0.7


def seen_walkers(folder: Path) -> dict[int, list[Any]]:
    """Return the rows of each walker in the record of the first vehicle, by its number."""
    history = read_history(folder)
    found: dict[int, list[Any]] = {}
    for row in history.others:
        if history.facts.actor_types.get(int(row["id"]), "").startswith("walker."):
            found.setdefault(int(row["id"]), []).append(row)
    return found


@pytest.mark.slow
def test_a_shuttle_that_another_one_warns_brakes_early_and_gently_for_a_person_that_it_cannot_see(
    services: Services, tmp_path: Path
) -> None:
    warned, alone = (
        braked(services, tmp_path, "Warned", "cooperative"),
        braked(services, tmp_path, "Alone", "behavioral"),
    )
    assert (warned.hits, alone.hits) == (False, True)
    assert warned.hardest_mps2 < 2.0
    assert alone.hardest_mps2 > 5.0
    assert warned.begins_s < alone.begins_s - 1.5


class Braked(NamedTuple):
    """How the first vehicle braked after it had reached 6 m/s."""

    begins_s: float
    hardest_mps2: float
    hits: bool


def braked(services: Services, folder: Path, agent: str, beside: str) -> Braked:
    """Drive the example with a hidden person, as one of its agents."""
    demand = folder / "no_persons.json"
    demand.write_text(json.dumps({"schema_version": 1, "stops": {}, "patience_min": 20}))
    options = ["--beside", beside, "--apart", 0.6, "--minutes", 0.4, "--demand", demand, "--no-holding", "--open"]
    _, run = services(f"{EXAMPLE}:{agent}", *options, "--seed", 1, name=agent)
    history = read_history(run)
    frames = history.frames
    speed_mps = np.hypot(frames["velocity_x_mps"], frames["velocity_y_mps"])
    fast = int(np.argmax(speed_mps > 6.0))
    brakes = fast + int(np.argmax(frames["applied_brake"][fast:] > 0.02))
    change_mps2 = (speed_mps[5:] - speed_mps[:-5]) / (5 * STEP_S)
    return Braked(float(frames["t_s"][brakes]), -float(change_mps2[fast:].min()), bool(history.collisions))
