"""`basu scenario run FILE.xosc`: an agent drives one entity, or none does, on the file's own road in a server."""

import json
import math

import pyarrow.parquet as pq
import pytest

from basu.cli import main
from basu_openscenario.playing.player import make_player
from basu_openscenario.reading.scenario_file import read_scenario
from basu_openscenario.staging.bodies import middle_of
from openscenario_texts import begins, event, lane_change, scenario, speed_action, story, vehicle, written
from traffic_texts import sink, source, swarm

AGENT = """
import carla
from basu.agents.autonomous_agent import AutonomousAgent


class Coasting(AutonomousAgent):
    def setup(self):
        pass

    def config(self):
        return {}

    def run_step(self, sensor_data):
        return carla.VehicleControl(brake=1.0)
"""
CLOSE_M = 0.05


@pytest.fixture
def cut_in(tmp_path):
    """A file in which another vehicle overtakes and changes into the ego's lane."""
    text = scenario(
        entities=vehicle("Ego") + vehicle("Other"),
        init=begins("Ego", 50, 8) + begins("Other", 65, 12, lane=-2),
        stories=story("Other", event("in", lane_change(-1, 2)), event("slower", speed_action(9, "linear", 2))),
        stop=6,
    )
    return written(tmp_path, text, "cut-in.xosc")


def record(folder):
    """Return rows of the record and the result of the one drive below a folder of runs."""
    (drive,) = (path.parent for path in (folder / "latest").glob("*/*/result.json"))
    return pq.read_table(drive / "history.parquet").to_pylist(), json.loads((drive / "result.json").read_text())


def apart_m(rows, file, name, of):
    """Return the greatest distance in m of an entity in a record from where its file has it."""
    player = make_player(read_scenario(file))
    player.step(0.0)
    worst_m = 0.0
    for row in rows[1:]:
        while player.world.time_s < row["t_s"] - rows[0]["t_s"] - 1e-6 and player.step(0.01):
            pass
        if player.is_over:
            break
        there, seen = middle_of(player.world.mover(name)), of(row)
        if seen is None:
            continue  # too far away for the record
        worst_m = max(worst_m, math.dist((there.x_m, there.y_m), (seen["x_m"], seen["y_m"])))
    return worst_m


def first_other(row):
    """Return the one entity beside the ego; None where it is too far away for the record."""
    return next(iter(row["others"]), None)


@pytest.mark.slow
@pytest.mark.usefixtures("plugin")
def test_without_an_agent_all_entities_move_as_written(cut_in, tmp_path, capsys):
    main(["scenario", "run", str(cut_in), "--workers", "1", "--output", str(tmp_path / "runs")])
    rows, result = record(tmp_path / "runs")
    assert result["case"]["id"] == "cut-in:driver=file", capsys.readouterr()
    assert [one["role"] for one in result["case"]["actors"]] == ["Other"]
    assert rows[-1]["t_s"] > 5.5
    assert apart_m(rows, cut_in, "Ego", lambda row: row) < CLOSE_M
    assert apart_m(rows, cut_in, "Other", first_other) < CLOSE_M


@pytest.mark.slow
@pytest.mark.usefixtures("plugin")
def test_an_agent_drives_the_entity_and_the_others_move_as_written(cut_in, tmp_path, capsys):
    agent = tmp_path / "my_agent.py"
    agent.write_text(AGENT, encoding="utf-8")
    words = ["--agent", str(agent), "--ego", "Ego", "--workers", "1", "--output", str(tmp_path / "runs")]
    main(["scenario", "run", str(cut_in), *words])
    rows, result = record(tmp_path / "runs")
    assert result["case"]["id"] == "cut-in:ego=Ego", capsys.readouterr()
    assert (
        max(math.hypot(row["velocity_x_mps"], row["velocity_y_mps"]) for row in rows[:10]) > 7.0
    )  # as the file begins
    assert math.hypot(rows[-1]["velocity_x_mps"], rows[-1]["velocity_y_mps"]) < 0.1  # the agent has braked
    assert rows[-1]["x_m"] < 70.0
    assert apart_m(rows, cut_in, "Other", first_other) < CLOSE_M


@pytest.mark.slow
@pytest.mark.usefixtures("plugin")
def test_traffic_is_in_the_record_and_the_same_again(tmp_path, capsys):
    init = source(262, radius=12, rate=0.5) + sink(430) + begins("Ego", 300, 4)
    file = written(tmp_path, scenario(init=init, stop=12, revision=(1, 3)), "traffic.xosc")
    found = []
    for nth in range(2):
        main(["scenario", "run", str(file), "--workers", "1", "--output", str(tmp_path / f"runs{nth}")])
        found.append(record(tmp_path / f"runs{nth}"))
    rows, result = found[0]
    assert rows == found[1][0], capsys.readouterr()
    roles = [one["role"] for one in result["case"]["actors"]]
    assert roles == [f"traffic-{nth}" for nth in range(1, len(roles) + 1)]
    assert 4 <= len(roles) <= 7  # one at once, and one each two seconds where there is room
    seen = [one for row in rows for one in row["others"]]
    assert max(math.hypot(one["velocity_x_mps"], one["velocity_y_mps"]) for one in seen) == pytest.approx(10.0, abs=0.5)
    assert result["collisions"]["number"] == 0  # vehicles behind the slower ego keep their distance


@pytest.mark.usefixtures("plugin")
@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("<OpenSCENARIO>", "cut-in.xosc:1: this is not well-formed XML"),
        (scenario(revision=(3, 0)), "version 3.0 is unknown"),
        (scenario(init=swarm("Ego", count=10**6) + begins("Ego", 50, 8)), "up to 200 vehicles of traffic at a time"),
        (scenario(init=begins("Ego", "$where", 8)), "'where' is not declared here"),
    ],
)
def test_bad_files_are_refused_before_a_server_starts(cut_in, tmp_path, capsys, monkeypatch, text, sentence):
    monkeypatch.setattr("basu.simulator.OwnServer.__init__", lambda *_, **__: pytest.fail("a server was started"))
    cut_in.write_text(text, encoding="utf-8")
    assert main(["scenario", "run", str(cut_in), "--workers", "1", "--output", str(tmp_path / "runs")]) == 2
    assert sentence in capsys.readouterr().err


@pytest.mark.usefixtures("plugin")
def test_the_ego_of_no_file_is_refused(tmp_path, capsys):
    words = ["cut_in_1", "--ego", "Ego", "--workers", "1", "--output", str(tmp_path / "runs")]
    assert main(["scenario", "run", *words]) == 2
    assert capsys.readouterr().err
