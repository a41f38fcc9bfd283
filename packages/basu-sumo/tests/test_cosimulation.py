"""Claims about ``basu sumo``: it follows another client's ticks or makes them, and leaves nothing behind."""

import threading
from dataclasses import replace
from pathlib import Path

import carla
import pytest

from basu.cli import main
from basu.errors import SimulatorError, UserError
from basu.options.run import RunOptions
from basu_sumo.cosimulation import cosimulate
from servers import RunningServer

pytest.importorskip("libsumo", reason="the extra for SUMO is not installed")
STEP_S = 0.05


def shown(world: carla.World) -> list[carla.Actor]:
    return [actor for actor in world.get_actors() if actor.attributes.get("role_name") == "sumo"]


@pytest.fixture
def options(simulator: RunningServer, monkeypatch: pytest.MonkeyPatch) -> RunOptions:
    """The options of random trips at the shared simulator; its network is not checked against the map."""
    monkeypatch.setattr("basu_sumo.cosimulation.MISFIT_M", float("inf"))
    return RunOptions(host="127.0.0.1", port=simulator.port, timeout_s=60.0, seed=3)


def small(options: RunOptions, folder: Path) -> RunOptions:
    return replace(options, sumo=str(folder / "small.sumocfg"))


def test_it_makes_the_ticks_and_leaves_the_world_as_it_was(options: RunOptions, folder: Path) -> None:
    world = carla.Client("127.0.0.1", options.port).get_world()
    before = world.get_settings()
    said = cosimulate(small(options, folder), step_s=STEP_S, makes_ticks=True, limit_s=2.0)
    assert said.startswith("SUMO's traffic    1 vehicles and 0 people in 2.0 s of simulated time")
    assert world.get_settings() == before
    assert shown(world) == []


@pytest.mark.parametrize(("tick_s", "ticks"), [(0.05, 60), (0.2, 15)])
def test_it_follows_another_client_s_ticks_with_as_many_steps_as_fit(
    options: RunOptions, folder: Path, tick_s: float, ticks: int
) -> None:
    client = carla.Client("127.0.0.1", options.port)
    client.set_timeout(60.0)
    world = client.get_world()
    before = world.get_settings()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, tick_s
    world.apply_settings(settings)
    said: list[str] = []
    follower = threading.Thread(
        target=lambda: said.append(cosimulate(small(options, folder), step_s=STEP_S, makes_ticks=False, limit_s=2.0))
    )
    follower.start()
    seen = 0
    while follower.is_alive():
        world.tick()
        seen = max(seen, len(shown(world)))
    follower.join()
    world.apply_settings(before)
    world.wait_for_tick(60.0)  # the client lists the actors of the last frame that it has received
    assert seen == 1
    assert said[0].startswith("SUMO's traffic    1 vehicles and 0 people in 2.")
    assert shown(world) == []


def test_without_ticks_it_says_what_to_start(options: RunOptions, folder: Path) -> None:
    world = carla.Client("127.0.0.1", options.port).get_world()
    before = world.get_settings()
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP_S
    world.apply_settings(settings)
    with pytest.raises(SimulatorError, match="no tick came within 2 s; start the program that ticks first, or add --t"):
        cosimulate(replace(small(options, folder), timeout_s=2.0), step_s=STEP_S, makes_ticks=False, limit_s=2.0)
    world.apply_settings(before)


def test_a_network_of_another_town_is_refused(simulator: RunningServer, folder: Path) -> None:
    options = RunOptions(host="127.0.0.1", port=simulator.port, timeout_s=60.0, sumo=str(folder / "small.sumocfg"))
    with pytest.raises(UserError, match=r"SUMO's network is not that of .*Linden: the map's spawn points lie on none"):
        cosimulate(options, step_s=STEP_S, makes_ticks=True, limit_s=1.0)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--step", "0"], "--step is 0; give a time above 0 s"),
        (["--for", "-1"], "--for is -1; give a time above 0 s"),
        (["no.sumocfg"], "--sumo no.sumocfg: there is no such file"),
        (["lorries"], "--sumo lorries: it may be a FILE.sumocfg, random, demand or none"),
        (["none"], "there is nothing to show with none"),
    ],
)
def test_bad_words_are_one_sentence(words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sumo", *words]) != 0
    assert sentence in capsys.readouterr().err
