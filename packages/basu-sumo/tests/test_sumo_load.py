"""Claims about what SUMO's traffic loses, about SUMO's own outputs, and about the options of both."""

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from basu.errors import UserError
from basu.options.run import RunOptions
from basu_sumo.link import Link, connected, in_process
from basu_sumo.load import Load
from basu_sumo.outputs import COLLISIONS, FOLDER, SAFETY, SUMMARY, TRIPS, Outputs

STEP_S = 0.05


def loaded(link: Link, seconds: float, people: int = 0) -> Load:
    """The load after so many seconds."""
    load = Load(link, STEP_S)
    for number in range(round(seconds / STEP_S)):
        link.step()
        load.tick((number + 1) * STEP_S, people)
    return load


def test_a_vehicle_that_begins_later_is_delayed_and_has_not_arrived(folder: Path) -> None:
    link = in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)
    load = Load(link, STEP_S)
    link.step()
    link.api.vehicle.remove("one")
    load.tick(STEP_S, 0, {"one"})
    assert (load.arrived, load.delayed) == (0, 1)
    link.close()


def test_a_free_vehicle_loses_little_and_a_stopped_one_loses_all_its_time(folder: Path) -> None:
    link = in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)
    free = loaded(link, 12.0, people=3)
    assert {(row.vehicles, row.people) for row in free.seconds} == {(1, 3)}
    assert sum(row.lost_s for row in free.seconds[8:]) < 1.0, "it drives about as fast as it may"
    assert 60.0 < sum(row.driven_m for row in free.seconds) < 140.0
    link.api.vehicle.setSpeed("one", 0.0)
    for _ in range(200):
        link.step()
    stopped = loaded(link, 5.0)
    assert [row.halted for row in stopped.seconds] == [1] * 5
    assert sum(row.lost_s for row in stopped.seconds) == pytest.approx(stopped.seconds[-1].t_s, abs=0.1)
    link.close()


def test_the_arrived_are_counted_and_carla_s_own_vehicles_are_not_traffic(folder: Path) -> None:
    link = in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)
    link.step()
    link.api.vehicle.add("carla7", link.api.vehicle.getRouteID("one"))
    load = loaded(link, 60.0)
    assert load.arrived == 1
    assert max(row.vehicles for row in load.seconds) == 1
    link.close()


def test_outputs_lie_in_the_run_s_folder_and_have_no_date(folder: Path, tmp_path: Path) -> None:
    seen = []
    for name in ("first", "second"):
        outputs = Outputs(tmp_path / name, "one")
        link = in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0, more=outputs.options)
        loaded(link, 5.0)
        link.close()
        outputs.finish()
        written = {path.name: path.read_bytes() for path in (tmp_path / name / FOLDER).iterdir()}
        assert set(written) == {TRIPS, SUMMARY, COLLISIONS, SAFETY}
        assert b'id="one"' in written[TRIPS], "a trip that goes on is written too"
        assert not any(b"generated on" in content for content in written.values())
        seen.append(written)
    assert seen[0] == seen[1]


def test_without_a_wish_there_are_no_outputs() -> None:
    outputs = Outputs(None, "one")
    assert outputs.options == ()
    outputs.finish()


def test_outputs_that_cannot_be_written_are_one_sentence(tmp_path: Path) -> None:
    (tmp_path / FOLDER).touch()
    with pytest.raises(UserError, match=r"cannot make .*sumo: File exists; leave out --sumo-output"):
        Outputs(tmp_path, "one")


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ({"sumo_port": 9, "sumo_output": True}, "--sumo-output is for a SUMO that basu starts"),
        ({"sumo_port": 9, "sumo_hour": 8.0}, "--sumo-hour is for a SUMO that basu starts"),
        ({"sumo": "random", "sumo_scale": 2.0}, "--sumo-scale is for a demand; --sumo random keeps --vehicles N"),
        ({"sumo": __file__.replace(".py", ".sumocfg"), "sumo_hour": 8.0}, "there is no such file"),
    ],
)
def test_options_that_do_not_go_together_are_one_sentence(words: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        RunOptions(**words).check()


def test_the_hour_of_a_finished_scenario_is_its_own(folder: Path) -> None:
    with pytest.raises(UserError, match=r"--sumo-hour is for a demand that basu makes; .*small\.sumocfg has its own"):
        RunOptions(sumo=str(folder / "small.sumocfg"), sumo_hour=8.0).check()


def test_a_libsumo_that_is_too_old_is_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    libsumo = pytest.importorskip("libsumo")
    monkeypatch.setattr(libsumo.simulation, "getVersion", lambda: (21, "SUMO 1.19.0"))
    with pytest.raises(UserError, match=r"the libsumo that is installed is SUMO 1\.19\.0; at least 1\.20 is needed"):
        in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0)
    monkeypatch.undo()
    in_process(folder / "small.sumocfg", step_s=STEP_S, seed=0).close()


def test_a_running_sumo_that_is_too_old_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    traci = pytest.importorskip("traci")
    closed = []
    old = SimpleNamespace(
        getVersion=lambda: (21, "SUMO v1_9_2+0001"),
        simulation=SimpleNamespace(getDeltaT=lambda: STEP_S),
        close=lambda: closed.append(True),
    )
    monkeypatch.setattr(traci, "connect", lambda **_: old)
    assert "traci" in sys.modules
    with pytest.raises(UserError, match=r"the SUMO at 127\.0\.0\.1:9 is SUMO v1_9_2\+0001; at least 1\.20 is needed"):
        connected("127.0.0.1", 9, step_s=STEP_S)
    assert closed == [True]
