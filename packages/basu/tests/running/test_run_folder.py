"""Claims about repeating a run: ``--config`` and the command in config.json drive the same run again, byte by byte."""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.outcome import Fault
from basu.routing.route_file import RouteDescription
from basu.running.run_folder import options_again
from basu.settings.document import RUN, command_of

ROUTE = RouteDescription(id="1", town="Linden", points=(), stops=(), source="r.xml")
ADJUSTED = [
    *("--harsh-stop", "3", "--penalty", "stop_sign=0.25", "--infraction-weight", "0.6"),
    *(
        "--scoring",
        '{"comfort_weights": {"service": 0.5}, "standing_place": {"forward_m": 1, "right_m": 0, "up_m": 0}}',
    ),
    *("--step-limit", "2", "--speeding-tolerance", "0.1", "--route-deviation", "0.2"),
]


def heard(monkeypatch: pytest.MonkeyPatch, words: list[str]) -> tuple[RunOptions, Scoring]:
    """What the command line makes of a command, up to where anything would be started."""
    found = []
    monkeypatch.setattr("basu.running.runner.run", lambda options, scoring: found.append((options, scoring)) or 0)
    assert main(words) == 0
    return found[0]


@pytest.mark.parametrize(
    "words",
    [
        ["basic"],
        ["forward", "--routes", "my routes.xml", "--seed", "9", "--record"],
        ["basic", "--vehicles", "30", "--walkers", "4", "--weather", "ClearSunset", "--vehicle", "vehicle.audi.tt"],
        ["basic", "--traffic-density", "2.5", *ADJUSTED],
        ["basic", "--no-scenarios", "--scenarios", "a.py", "--keys", "session.json", "--agent-config", "x=-1"],
    ],
)
def test_the_command_of_a_run_asks_for_the_same_again(monkeypatch: pytest.MonkeyPatch, words: list[str]) -> None:
    options, scoring = heard(monkeypatch, ["run", *words, "--output", "elsewhere", "--host", "there"])
    wanted = options_again(options, ROUTE, options.seed)
    program, *again = command_of(RUN, wanted, scoring)
    assert program == "basu"
    same, same_scoring = heard(monkeypatch, [*again, "--output", "elsewhere", "--host", "there"])
    assert same_scoring == scoring
    assert same == wanted
    assert same.route_id == "1"


def test_one_run_of_a_series_repeats_with_its_own_seed_and_route() -> None:
    options = RunOptions(routes_subset="0-3", repetitions=4, seed=5, series="night", record_keys=Path("k.json"))
    again = options_again(options, ROUTE, 7)
    assert (again.routes_subset, again.route_id, again.repetitions, again.seed) == (None, "1", 1, 7)
    assert again.keys == "k.json"
    assert command_of(RUN, again, Scoring()) == [
        *("basu", "run", "basic", "--route-id", "1", "--seed", "7", "--keys", "k.json"),
    ]


def left(folder: Path) -> tuple[bytes, bytes, dict[str, Any], dict[str, Any]]:
    """The bytes of a run's record, and its result and config without dates, wall times and the server's count."""
    result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    config = json.loads((folder / "config.json").read_text(encoding="utf-8"))
    for name in ("started", "wall_s", "first_server_frame"):  # the server counts on from run to run
        result["meta"].pop(name)
    config.pop("started")
    config["session"].pop("output")
    return (folder / "history.parquet").read_bytes(), (folder / "route.json").read_bytes(), result, config


@pytest.mark.slow
@pytest.mark.usefixtures("one_server")
def test_config_and_command_repeat_the_run_byte_by_byte(
    tmp_path: Path, route_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    agent = tmp_path / "two.py"
    agent.write_text(
        "import random\n"
        "class Slow(AutonomousAgent):\n"
        "    def setup(self): self.steps = 0\n"
        "    def config(self): return {}\n"
        "    def run_step(self, sensor_data):\n"
        "        self.steps += 1\n"
        "        if self.steps > 30: raise ValueError('enough')\n"
        "        return carla.VehicleControl(throttle=0.3 + 0.5 * random.random())\n"
        "class Fast(Slow): pass\n"
    )
    words = [f"{agent}:Slow", "--routes", str(route_file), *ADJUSTED, "--vehicles", "5", "--seed", "6"]
    first = tmp_path / "first"
    assert main(["run", *words, "--repetitions", "2", "--output", str(first)]) == Fault.AGENT.value
    assert "to repeat         basu run --config " in capsys.readouterr().out
    wanted = left(first / "latest")
    assert wanted[3]["seed"] == 7
    assert wanted[2]["scoring"]["harsh_stop_mps2"] == 3.0
    config = str(first / "latest" / "config.json")
    main(["run", "--config", config, "--output", str(tmp_path / "second")])
    assert left(tmp_path / "second" / "latest") == wanted
    main([*wanted[3]["command"][1:], "--output", str(tmp_path / "third")])
    assert left(tmp_path / "third" / "latest") == wanted
    main(["run", "--config", config, "--output", str(tmp_path / "other"), "--seed", "8", "--harsh-stop", "1"])
    other = left(tmp_path / "other" / "latest")
    assert other[0] != wanted[0], "the agent draws its throttle, so another seed is another run"
    assert other[2]["scoring"] == {**wanted[2]["scoring"], "harsh_stop_mps2": 1.0}
