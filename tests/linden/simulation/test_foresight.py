"""Claims about frames that are computed ahead: they are the same frames, and never one that something has overtaken."""

from collections.abc import Callable

import numpy as np
import pytest

from linden.maps.facts import derive
from linden.maps.library import LoadedMap
from linden.physics.bodies import Bodies
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.episode import EpisodeSettings, WeatherParameters
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.simulation import foresight
from linden.simulation.foresight import MOST_IN_VAIN, TRIED_AGAIN
from linden.world import World
from opendrive_texts import street_through_junction

STREET = street_through_junction()
STEP_S = 0.05
SETTINGS = EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=STEP_S)


def street(cars: int = 6) -> World:
    """Cars that drive, the last two of them into each other."""
    simulation = World(LoadedMap(name="street", text=STREET, **vars(derive(STREET))), SETTINGS)
    for place in range(cars):
        pose = Transform(Vector3D(12.0 * place, 300.0, 1.0), Rotation())
        simulation.spawn(ActorDescription(0, "vehicle.tesla.model3"), pose)
        simulation.episode.bodies.set_control(place, VehicleControl(throttle=0.9 - 0.1 * place))
    return simulation


def counted(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Return a list that gets an entry for every frame of physics that is computed."""
    computed: list[float] = []
    real = foresight.advance

    def advance(*arguments: object) -> object:
        computed.append(STEP_S)
        return real(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(foresight, "advance", advance)
    return computed


def same(ours: World, theirs: World) -> bool:
    """Whether two worlds are equal, byte for byte."""
    ours_now, theirs_now = ours.episode, theirs.episode
    return (
        ours_now.bodies.state.tobytes() == theirs_now.bodies.state.tobytes()
        and ours_now.actors.rows.tobytes() == theirs_now.actors.rows.tobytes()
        and ours_now.contacts.tobytes() == theirs_now.contacts.tobytes()
    )


def test_frames_computed_ahead_are_those_that_would_have_been(monkeypatch: pytest.MonkeyPatch) -> None:
    computed = counted(monkeypatch)
    ahead, plain = street(), street()
    touched = 0
    for _ in range(200):
        ahead.look_ahead()
        ahead.step(STEP_S)
        plain.step(STEP_S)
        touched += len(plain.episode.contacts)
        assert same(ahead, plain)
    assert touched > 0
    assert len(computed) == 400


def test_looking_ahead_changes_nothing_that_can_be_seen() -> None:
    simulation = street()
    for _ in range(20):
        simulation.step(STEP_S)
    before = simulation.episode.bodies.state.tobytes()
    simulation.look_ahead()
    assert simulation.episode.bodies.state.tobytes() == before
    assert simulation.frame == 20


def steer(bodies: Bodies) -> None:
    bodies.set_control(1, VehicleControl(throttle=1.0, steer=0.2))


def push(bodies: Bodies) -> None:
    bodies.state["impulse"][0] = 500.0


def change(bodies: Bodies) -> None:
    bodies.set_physics_control(2, bodies.physics_control(2)._replace(mass=5000.0))


def remove(bodies: Bodies) -> None:
    bodies.remove(3)


@pytest.mark.parametrize("act", [steer, push, change, remove])
def test_what_happens_after_the_look_ahead_counts(act: Callable[[Bodies], None]) -> None:
    ahead, plain = street(), street()
    for simulation in (ahead, plain):
        for _ in range(30):
            simulation.step(STEP_S)
        if simulation is ahead:
            simulation.look_ahead()
        act(simulation.episode.bodies)
        for _ in range(3):
            simulation.step(STEP_S)
    assert ahead.episode.bodies.state.tobytes() == plain.episode.bodies.state.tobytes()


def test_weather_and_another_step_count_too() -> None:
    ahead, plain = street(), street()
    for simulation in (ahead, plain):
        if simulation is ahead:
            simulation.look_ahead()
        simulation.episode.weather = WeatherParameters(*simulation.episode.weather)._replace(wetness=90.0)
        simulation.step(STEP_S)
        if simulation is ahead:
            simulation.look_ahead()
        simulation.step(0.02)
    assert same(ahead, plain)


def test_a_world_that_is_always_changed_is_looked_ahead_in_seldom(monkeypatch: pytest.MonkeyPatch) -> None:
    computed = counted(monkeypatch)
    simulation = street()
    frames = 2 * TRIED_AGAIN
    for number in range(frames):
        simulation.look_ahead()
        simulation.episode.bodies.set_control(1, VehicleControl(throttle=0.5, steer=0.001 * (number % 7)))
        simulation.step(STEP_S)
    assert frames < len(computed) <= frames + 3 * MOST_IN_VAIN


def test_without_a_fixed_step_there_is_nothing_to_foresee(monkeypatch: pytest.MonkeyPatch) -> None:
    computed = counted(monkeypatch)
    simulation = street()
    simulation.settings = EpisodeSettings(synchronous_mode=True)
    simulation.look_ahead()
    assert not computed


def test_bodies_are_as_they_were_where_memory_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = street()
    simulation.step(STEP_S)
    bodies = simulation.episode.bodies
    before = bodies.state.tobytes()

    def fail(changed: Bodies, *_: object) -> object:
        changed.position[0] += 1.0
        raise MemoryError

    with monkeypatch.context() as patch:
        patch.setattr(foresight, "advance", fail)
        simulation.look_ahead()
    assert bodies.state.tobytes() == before
    simulation.step(STEP_S)


def test_the_states_are_whole_words() -> None:
    bodies = Bodies()
    assert bodies.state.itemsize % np.uint64().itemsize == 0
