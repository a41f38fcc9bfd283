"""Claims about whole runs amid SUMO's traffic, in a live simulator."""

import json
from pathlib import Path
from typing import Any

import pytest

from basu.cli import main
from basu.errors import UserError
from servers import RunningServer


def run(simulator: RunningServer, route_file: Path, output: Path, *options: str) -> tuple[int, dict[str, Any], Path]:
    """``basu run basic`` at the shared simulator: exit status, result and folder."""
    address = ["--host", "127.0.0.1", "--port", str(simulator.port)]
    code = main(["run", "basic", *address, "--routes", str(route_file), "--output", str(output), *options])
    result = output / "latest" / "result.json"
    return code, json.loads(result.read_text()) if result.exists() else {}, output / "latest"


@pytest.mark.slow
@pytest.mark.usefixtures("one_server")
def test_the_same_seed_gives_the_same_bytes(route_file: Path, tmp_path: Path) -> None:
    """Each run has a world of its own: in a shared one the lights have gone on meanwhile."""
    seen = []
    for name in ("first", "second"):
        output = tmp_path / name
        options = ["--sumo", "random", "--vehicles", "30", "--seed", "3", "--stop-after", "8", "--output", str(output)]
        assert main(["run", "basic", "--in-process", "--routes", str(route_file), *options]) == 0
        result = json.loads((output / "latest" / "result.json").read_text())
        assert result["meta"]["traffic"]["vehicles"] >= 30
        seen.append((output / "latest" / "history.parquet").read_bytes())
    assert seen[0] == seen[1]


def test_a_network_of_another_town_is_the_set_up_s_fault(
    simulator: RunningServer, route_file: Path, tmp_path: Path, folder: Path
) -> None:
    code, result, _ = run(simulator, route_file, tmp_path / "runs", "--sumo", str(folder / "small.sumocfg"))
    assert code != 0
    assert (result["status"], result["fault"]) == ("SetupFailed", "setup")
    assert result["message"].startswith("SUMO's network is not that of Linden: route 'piece' was tried")


def test_a_sumo_that_dies_in_the_middle_is_the_simulator_s_failure_and_the_run_is_written(
    simulator: RunningServer, route_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import libsumo  # noqa: PLC0415 - an extra

    step, steps = libsumo.simulationStep, iter(range(40))

    def dies(*arguments: object) -> object:
        if next(steps, None) is None:
            raise libsumo.FatalTraCIError("connection closed by SUMO")
        return step(*arguments)

    monkeypatch.setattr(libsumo, "simulationStep", dies)
    options = ("--sumo", "random", "--vehicles", "5", "--seed", "3")
    code, result, folder = run(simulator, route_file, tmp_path / "runs", *options)
    assert code != 0
    assert (result["status"], result["fault"]) == ("SimulatorFailed", "simulator")
    assert "SUMO failed at making a step (step 40): connection closed by SUMO" in result["message"]
    assert (folder / "history.parquet").exists()


def test_a_type_that_no_blueprint_shows_is_the_set_up_s_fault(
    simulator: RunningServer, route_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unknown(*_: object) -> str:
        raise UserError("SUMO's vehicle type 'ferry' is of the class 'ship', which no blueprint shows")

    monkeypatch.setattr("basu_sumo.models.Models.of", unknown)
    options = ("--sumo", "random", "--vehicles", "5", "--seed", "3")
    code, result, _ = run(simulator, route_file, tmp_path / "runs", *options)
    assert code != 0
    assert (result["status"], result["fault"]) == ("SetupFailed", "setup")
    assert result["message"].startswith("SUMO's vehicle type 'ferry' is of the class 'ship'")
