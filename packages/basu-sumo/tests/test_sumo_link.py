"""Claims about SUMO beside a run, without a simulator: poses, types, scenarios, faults of SUMO, random trips."""

import math
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from basu.errors import SimulatorError, UserError
from basu_sumo import link as links
from basu_sumo.frames import from_sumo, to_sumo
from basu_sumo.link import connected, in_process
from basu_sumo.models import Model, Models
from basu_sumo.random_trips import RandomTrips
from basu_sumo.scenario import config_in, made_of, named_folder

OFFSET_M = (643.3, 810.58)
STEP_S = 0.05
ANSWER_LIMIT_S = 60.0


@pytest.mark.parametrize(
    ("angle_deg", "x_m", "y_m", "yaw_deg"),
    [(0.0, 10.0, -18.0, -90.0), (90.0, 8.0, -20.0, 0.0), (180.0, 10.0, -22.0, 90.0), (270.0, 12.0, -20.0, 180.0)],
)
def test_a_vehicle_s_middle_lies_half_its_length_behind_its_front(
    angle_deg: float, x_m: float, y_m: float, yaw_deg: float
) -> None:
    front = (10.0 + OFFSET_M[0], 20.0 + OFFSET_M[1], 5.0)
    pose = from_sumo(front, angle_deg, 0.0, 4.0, OFFSET_M)
    assert (pose.x_m, pose.y_m, pose.z_m) == pytest.approx((x_m, y_m, 5.0))
    assert math.cos(math.radians(pose.yaw_deg - yaw_deg)) == pytest.approx(1.0)
    back = to_sumo(pose.x_m, pose.y_m, pose.yaw_deg, 2.0, OFFSET_M)
    assert back == pytest.approx((front[0], front[1], angle_deg))


def test_uphill_the_middle_is_lower_than_the_front_and_the_nose_points_up() -> None:
    pose = from_sumo((0.0, 0.0, 10.0), 90.0, 6.0, 4.0, (0.0, 0.0))
    assert pose.pitch_deg == 6.0
    assert pose.z_m == pytest.approx(10.0 - 2.0 * math.sin(math.radians(6.0)))


class Library:
    """Blueprints by base type, as a client's library has them."""

    def __init__(self, **base_types: str) -> None:
        self._base_types = base_types

    def filter(self, _pattern: str) -> list["Blueprint"]:
        return [Blueprint(f"vehicle.{name.replace('__', '.')}", base) for name, base in self._base_types.items()]


class Blueprint:
    def __init__(self, name: str, base: str) -> None:
        self.id, self._base = name, base

    def has_attribute(self, _name: str) -> bool:
        return True

    def get_attribute(self, _name: str) -> "Blueprint":
        return self

    def as_str(self) -> str:
        return self._base


def test_a_type_is_shown_by_its_namesake_else_by_the_most_alike_of_its_class() -> None:
    models = Models(Library(audi__a2="car", tesla__model3="car", mitsubishi__fusorosa="bus"))  # type: ignore[arg-type]
    assert models.of("vehicle.audi.a2", "passenger", 3.7) == Model("vehicle.audi.a2", is_exact=True)
    assert models.of("vehicle.audi.a2@x.7", "passenger", 3.7) == Model("vehicle.audi.a2", is_exact=True)
    assert models.of("short", "passenger", 3.5) == Model("vehicle.audi.a2", is_exact=False)
    assert models.of("long", "taxi", 5.2) == Model("vehicle.tesla.model3", is_exact=False)
    assert models.of("coach", "coach", 14.0) == Model("vehicle.mitsubishi.fusorosa", is_exact=False)


def test_a_type_that_no_blueprint_shows_is_refused_in_a_sentence() -> None:
    models = Models(Library(audi__a2="car"))  # type: ignore[arg-type]
    with pytest.raises(UserError, match="SUMO's vehicle type 'ferry' is of the class 'ship', which no blueprint shows"):
        models.of("ferry", "ship", 60.0)


def test_a_folder_that_is_named_is_found_or_made_or_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "net").mkdir()
    assert named_folder("net", "Linden", None) == tmp_path / "net"
    assert named_folder("data/sumo//linden", "Linden", None) is None
    with pytest.raises(UserError, match="the agent's SUMO folder 'data/sumo/atlantis' was not found"):
        named_folder("data/sumo/atlantis", "Linden", None)


def test_the_configuration_of_a_folder_is_the_only_one(folder: Path, tmp_path: Path) -> None:
    assert config_in(folder, is_random=False).name == "small.sumocfg"
    assert config_in(folder, is_random=True).name == "small.empty.sumocfg"
    with pytest.raises(UserError, match=r"has no \.sumocfg; name one file with --sumo"):
        config_in(tmp_path, is_random=False)
    for name in ("a", "b"):
        (tmp_path / f"{name}.sumocfg").touch()
    with pytest.raises(UserError, match=r"has 2 \.sumocfg files"):
        config_in(tmp_path, is_random=False)


def test_a_town_s_folder_is_made_once_and_a_failure_is_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    maker = [
        sys.executable,
        "-c",
        "import sys, pathlib; p = pathlib.Path(sys.argv[5]); p.mkdir(); (p / 'a.sumocfg').touch()",
    ]
    first = made_of("<OpenDRIVE/>", "Town", 1, maker)
    assert [path.name for path in first.iterdir()] == ["a.sumocfg"]
    assert made_of("<OpenDRIVE/>", "Town", 1, ["no-such-program"]) == first
    failing = [sys.executable, "-c", "import sys; sys.exit('linden: no road at all')"]
    with pytest.raises(UserError, match="no SUMO network could be made of Town: no road at all"):
        made_of("<OpenDRIVE/>", "Town", 2, [*failing])
    assert [path.name for path in (tmp_path / "basu" / "sumo").iterdir()] == [first.name], "no draft is left"


def test_without_sumo_the_extra_is_named(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "libsumo", None)
    with pytest.raises(UserError, match="SUMO is not installed; install it with: pip install basu-sumo"):
        in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)


def test_a_configuration_that_is_not_there_or_no_configuration_is_refused(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"there is no SUMO configuration .*none\.sumocfg"):
        in_process(folder / "none.sumocfg", step_s=STEP_S, seed=0)
    bad = tmp_path / "bad.sumocfg"
    bad.write_text("rubbish")
    with pytest.raises(UserError, match=r"SUMO refuses .*bad\.sumocfg: Could not load configuration"):
        in_process(bad, step_s=STEP_S, seed=0)
    bad.write_text('<configuration><input><net-file value="away.net.xml"/></input></configuration>')
    with pytest.raises(UserError, match=r"SUMO refuses .*bad\.sumocfg: its net-file away\.net\.xml is not there"):
        in_process(bad, step_s=STEP_S, seed=0)


def test_an_unknown_vehicle_type_is_named(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "x.rou.xml").write_text('<routes><trip id="x" type="no.such" depart="0" from="ab" to="bc"/></routes>')
    config = tmp_path / "x.sumocfg"
    config.write_text(
        f'<configuration><input><net-file value="{folder}/small.net.xml"/><route-files value="x.rou.xml"/></input>'
        "</configuration>"
    )
    with pytest.raises(UserError, match=r"The vehicle type 'no\.such' for vehicle 'x' is not known"):
        in_process(config, step_s=STEP_S, seed=0)


def test_a_process_holds_one_sumo_and_another_one_after_it(folder: Path) -> None:
    first = in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)
    with pytest.raises(UserError, match="this process holds another SUMO already"):
        in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)
    first.close()
    first.close()
    second = in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)
    second.step()
    assert second.api.vehicle.getIDList() == ("one",)
    second.close()


def test_a_refusal_of_sumo_in_the_middle_is_the_simulator_s_failure(folder: Path) -> None:
    link = in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)
    link.step()
    with (
        pytest.raises(SimulatorError, match=r"SUMO failed at naming a vehicle \(step 1\): .*nobody"),
        link.answering("naming a vehicle"),
    ):
        link.api.vehicle.getSpeed("nobody")
    link.close()


@contextmanager
def running_sumo(folder: Path, step_s: float) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """SUMO as a process of its own that waits for one client."""
    sumo = pytest.importorskip("sumo")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])
    program = Path(sumo.SUMO_HOME) / "bin" / "sumo"
    arguments = ["-c", str(folder / "small.sumocfg"), "--remote-port", str(port), "--step-length", str(step_s)]
    process = subprocess.Popen([str(program), *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield process, port
    finally:
        process.kill()
        process.wait()


def link_to(port: int) -> links.Link:
    """The link to a SUMO that may still be starting."""
    deadline = time.monotonic() + ANSWER_LIMIT_S
    while True:
        try:
            return connected("127.0.0.1", port, step_s=STEP_S)
        except UserError as error:  # noqa: PERF203 - it waits for a process
            if "no SUMO answers" not in str(error) or time.monotonic() > deadline:
                raise


def test_a_sumo_that_is_killed_in_the_middle_is_the_simulator_s_failure(folder: Path) -> None:
    with running_sumo(folder, STEP_S) as (process, port):
        link = link_to(port)
        link.step()
        process.kill()
        process.wait()
        with pytest.raises(SimulatorError, match=r"SUMO failed at making a step \(step 1\): "):
            link.step()
        link.close()


def test_a_running_sumo_of_another_step_is_refused(folder: Path) -> None:
    with (
        running_sumo(folder, 0.1) as (_, port),
        pytest.raises(
            UserError, match=r"makes steps of 0\.1 s and the run ones of 0\.05 s; start it with --step-length"
        ),
    ):
        link_to(port)


def test_where_no_sumo_answers_the_port_is_named() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        port = int(taken.getsockname()[1])
        with pytest.raises(UserError, match=f"no SUMO answers at 127.0.0.1:{port}: .*start one with --remote-port"):
            connected("127.0.0.1", port, step_s=STEP_S)


def places_of(folder: Path, seed: int) -> list[dict[str, tuple[float, float]]]:
    """Where five vehicles on random trips are, a second apart."""
    link = in_process(folder / "small.empty.sumocfg", step_s=STEP_S, seed=seed)
    trips = RandomTrips(link, 5, seed)
    seen = []
    for number in range(1200):
        trips.fill()
        link.step()
        if number % 20 == 0:
            names = sorted(link.api.vehicle.getIDList())
            seen.append({name: link.api.vehicle.getPosition(name) for name in names})
    link.close()
    return seen


def test_random_trips_follow_their_seed_and_replace_arrived_vehicles(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("basu_sumo.random_trips.LEAST_EDGES", 2)
    first = places_of(folder, 3)
    assert first == places_of(folder, 3)
    assert first != places_of(folder, 4)
    assert len({name for places in first for name in places}) > 5
    assert max(len(places) for places in first) <= 5
