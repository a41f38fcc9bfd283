"""Walkers that are led, and walkers that are struck."""

from pathlib import Path

import numpy as np
import pytest

from fleet import slow_uncompiled
from linden.maps.facts import derive
from linden.maps.library import LoadedMap
from linden.physics.step import CONTACT
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.control import WalkerControl
from linden.protocol.values.enums import AttributeType
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.replay.file.read import Recording
from linden.simulation.actor_table import ActorRefusal
from linden.simulation.bones import bones_of, sockets_of
from linden.world import World
from opendrive_texts import street_through_junction

DT_S = 0.05
HALF_M = 0.93
PAVEMENT_M = 0.15
TEXT = street_through_junction()
MAP = LoadedMap(name="street", text=TEXT, **vars(derive(TEXT)))


def at(x: float, y: float, z: float, yaw: float = 0.0) -> Transform:
    return Transform(Vector3D(x, y, z), Rotation(0.0, yaw, 0.0))


def walker(simulation: World, pose: Transform, *, invincible: bool = True, kind: str = "walker.pedestrian.0001") -> int:
    attribute = AttributeValue("is_invincible", AttributeType.BOOL, "true" if invincible else "false")
    return simulation.spawn(ActorDescription(0, kind, (attribute,)), pose).id


def led(simulation: World, actor_id: int, pose: Transform, speed_mps: float = 1.5) -> None:
    episode = simulation.episode
    episode.walkers.lead(episode, [actor_id], [pose], np.array([speed_mps]))
    simulation.step(DT_S)


@pytest.fixture
def simulation() -> World:
    return World(MAP)


@pytest.fixture
def follower(simulation: World) -> int:
    """A walker as a controller takes it over: no physics, no collisions."""
    actor_id = walker(simulation, at(10.0, 4.25, 2.0))
    slot = simulation.episode.walker(actor_id)
    simulation.episode.bodies.set_simulate(slot, simulate=False)
    simulation.episode.bodies.collides[slot] = False
    return actor_id


def row(simulation: World, actor_id: int) -> np.void:
    actors = simulation.episode.actors
    return actors.rows[actors.row(actor_id)]


@pytest.mark.parametrize("told_m", [0.0, PAVEMENT_M, 0.5])
def test_a_led_walker_stands_on_the_ground_however_roughly_the_mesh_lies(
    simulation: World, follower: int, told_m: float
) -> None:
    led(simulation, follower, at(12.0, 4.25, told_m))
    assert simulation.episode.transform(follower).location.z == pytest.approx(PAVEMENT_M + HALF_M, abs=1e-9)


def test_a_walker_led_where_no_ground_is_stays_at_its_given_place(simulation: World, follower: int) -> None:
    led(simulation, follower, at(12.0, 4.25, 8.0))
    assert simulation.episode.transform(follower).location.z == pytest.approx(8.0 + HALF_M)


def test_its_velocity_turn_and_acceleration_are_those_of_its_places(simulation: World, follower: int) -> None:
    led(simulation, follower, at(10.0, 4.25, PAVEMENT_M))
    led(simulation, follower, at(10.0, 4.25, PAVEMENT_M))
    led(simulation, follower, at(10.06, 4.33, PAVEMENT_M, yaw=5.0))
    seen = row(simulation, follower)
    assert seen["velocity"] == pytest.approx((1.2, 1.6, 0.0), abs=1e-5)
    assert seen["angular_velocity"] == pytest.approx((0.0, 0.0, 100.0), abs=1e-3)
    assert seen["acceleration"] == pytest.approx((24.0, 32.0, 0.0), abs=1e-3)
    led(simulation, follower, at(10.06, 4.33, PAVEMENT_M, yaw=5.0))
    assert not row(simulation, follower)["velocity"].any()
    assert simulation.episode.walkers.walked_m(follower) == pytest.approx(0.1, abs=1e-6)


def test_a_jump_to_another_place_is_no_motion(simulation: World, follower: int) -> None:
    led(simulation, follower, at(40.0, 4.25, PAVEMENT_M))
    assert not row(simulation, follower)["velocity"].any()


def test_walkers_led_together_are_where_they_are_when_led_one_after_the_other() -> None:
    dice = np.random.default_rng(3)
    states = []
    for together in (True, False):
        simulation = World(MAP)
        episode = simulation.episode
        ids = [walker(simulation, at(5.0 + 2.0 * nth, 4.25, 2.0)) for nth in range(8)]
        dice = np.random.default_rng(3)
        for _ in range(5):
            places = [
                Transform(
                    Vector3D(*dice.uniform((4.0, 4.0, 0.0), (20.0, 4.5, 0.2))), Rotation(*dice.normal(0.0, 300.0, 3))
                )
                for _ in ids
            ]
            speeds_mps = dice.uniform(0.0, 2.0, len(ids))
            if together:
                episode.walkers.lead(episode, ids, places, speeds_mps)
            else:
                for nth, actor_id in enumerate(ids):
                    episode.walkers.lead(episode, [actor_id], places[nth : nth + 1], speeds_mps[nth : nth + 1])
            simulation.step(DT_S)
        states.append(episode.bodies.state[: episode.bodies.count].tobytes())
    assert states[0] == states[1]


def test_a_walker_that_is_no_longer_led_stands(simulation: World, follower: int) -> None:
    led(simulation, follower, at(10.0, 4.25, PAVEMENT_M))
    led(simulation, follower, at(10.1, 4.25, PAVEMENT_M))
    simulation.step(DT_S)
    simulation.step(DT_S)
    assert not row(simulation, follower)["velocity"].any()


def strike(simulation: World, speed_mps: float) -> None:
    """Drive a car at a walker at (20, 1.75) and let it hit."""
    car = simulation.spawn(ActorDescription(0, "vehicle.tesla.model3"), at(8.0, 1.75, 0.3)).id
    for _ in range(20):
        simulation.step(DT_S)
    episode = simulation.episode
    episode.bodies.set_target_velocity(episode.body(car), Vector3D(speed_mps, 0.0, 0.0))
    for _ in range(round(11.0 / speed_mps / DT_S)):
        simulation.step(DT_S)


def test_a_walker_struck_by_a_car_falls_lies_and_is_gone_after_ten_seconds(simulation: World) -> None:
    victim = walker(simulation, at(20.0, 1.75, 1.0), invincible=False)
    strike(simulation, 10.0)
    episode = simulation.episode
    assert episode.walkers.is_dead(victim)
    for _ in range(20):
        simulation.step(DT_S)
    pose = episode.transform(victim)
    assert abs(pose.rotation.pitch) == pytest.approx(90.0)
    assert pose.location.z == pytest.approx(0.188, abs=0.02)
    for _ in range(170):
        simulation.step(DT_S)
    assert victim in episode.actors
    for _ in range(30):
        simulation.step(DT_S)
    assert victim not in episode.actors


def test_an_animal_that_is_struck_falls_onto_its_side_and_has_no_pose(simulation: World) -> None:
    deer = walker(simulation, at(20.0, 1.75, 0.5, yaw=90.0), invincible=False, kind="walker.animal.deer")
    episode = simulation.episode
    assert len(sockets_of(episode, deer).names) == 0
    with pytest.raises(ActorRefusal, match="could not be found"):
        bones_of(episode, deer)
    with pytest.raises(ActorRefusal, match="animals have no bones"):
        episode.poses.take(episode, deer)
    strike(simulation, 10.0)
    assert episode.walkers.is_dead(deer)
    for _ in range(20):
        simulation.step(DT_S)
    pose = episode.transform(deer)
    assert (abs(pose.rotation.roll), pose.rotation.pitch) == (pytest.approx(90.0), pytest.approx(0.0, abs=1e-3))
    assert pose.location.z == pytest.approx(0.225, abs=0.02)


def test_an_invincible_one_is_pushed_and_lives(simulation: World) -> None:
    victim = walker(simulation, at(20.0, 1.75, 1.0))
    strike(simulation, 10.0)
    episode = simulation.episode
    assert not episode.walkers.is_dead(victim)
    assert episode.transform(victim).location.x > 20.5
    assert episode.transform(victim).rotation.pitch == pytest.approx(0.0)


@slow_uncompiled
def test_a_shove_kills_no_walker(simulation: World) -> None:
    victim = walker(simulation, at(20.0, 1.75, 1.0), invincible=False)
    strike(simulation, 1.5)
    assert not simulation.episode.walkers.is_dead(victim)


def test_the_dead_do_not_move_on_their_own(simulation: World, follower: int) -> None:
    episode = simulation.episode
    episode.bodies.set_walker_control(episode.walker(follower), WalkerControl(Vector3D(1.0, 0.0, 0.0), 1.5))
    episode.walkers.die(episode, follower)
    before = episode.transform(follower).location
    with pytest.raises(ActorRefusal, match="Walker is already dead"):
        episode.walkers.refuse_dead(follower)
    for _ in range(20):
        simulation.step(DT_S)
    assert episode.transform(follower).location[:2] == pytest.approx(before[:2])


def test_what_touches_a_corpse_when_it_goes_breaks_no_frame(
    simulation: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    episode = simulation.episode
    victim = walker(simulation, at(20.0, 1.75, 1.0), invincible=False)
    car = simulation.spawn(ActorDescription(0, "vehicle.tesla.model3"), at(10.0, 1.75, 0.5))
    sensor = simulation.spawn(ActorDescription(0, "sensor.other.collision"), Transform(), parent_id=car.id)
    slots = car.slot, episode.actors.get(victim).slot

    def touching(*_: object) -> np.ndarray:
        """Let the two touch in every frame, which needs a bumper lower than most."""
        contacts = np.zeros(1, CONTACT)
        contacts["a"], contacts["b"] = slots
        return contacts

    simulation.recorder.start(tmp_path / "end.log", episode, "street", lambda: 0.0, additional_data=False)
    episode.walkers.die(episode, victim)
    monkeypatch.setattr("linden.world.advance", touching)
    collisions = 0
    while victim in episode.actors:
        simulation.step(DT_S)
        collisions += len(simulation.measure({sensor.stream_id}))
    assert collisions > 100
    simulation.recorder.stop()
    with Recording(tmp_path / "end.log") as recording:
        assert [frame.number for frame in recording.frames()][-1] == simulation.frame
