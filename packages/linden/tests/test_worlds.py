"""Many worlds stepped together, beside the server's world and beside the same worlds one by one."""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import linden
from linden.errors import LindenError, Refusal, UserError
from linden.maps.library import HOME_MAP, LoadedMap, MapLibrary
from linden.physics.bodies import FARTHEST_M
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.control import VehicleControl, WalkerControl
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.snapshot import VEHICLE_ROW
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.world import World
from linden.worlds import Worlds

CAR, SHUTTLE, WALKER, CONE = (
    "vehicle.tesla.model3",
    "vehicle.easymile.ez10",
    "walker.pedestrian.0003",
    "static.prop.trafficcone01",
)
STEPS = 120


@pytest.fixture(scope="module")
def maps() -> MapLibrary:
    library = MapLibrary()
    library.load(HOME_MAP)
    return library


def ahead(maps: MapLibrary, point: int, along_m: float, up_m: float = 0.0) -> list[float]:
    """A pose so far ahead of a spawn point."""
    (x, y, z), (pitch, yaw, roll) = maps.load(HOME_MAP).spawn_points[point]
    return [x + along_m * np.cos(np.radians(yaw)), y + along_m * np.sin(np.radians(yaw)), z + up_m, pitch, yaw, roll]


def populated(maps: MapLibrary, count: int, threads: int = 0) -> Worlds:
    """Worlds in each of which a car meets a standing shuttle, a walker and a cone."""
    worlds = Worlds(count=count, maps=maps, threads=threads)
    worlds.spawn(CAR, 30)
    worlds.spawn(SHUTTLE, ahead(maps, 30, 14.0))
    worlds.spawn(WALKER, ahead(maps, 30, -6.0, 0.6))
    worlds.spawn(CONE, ahead(maps, 30, 6.0))
    return worlds


def controls_of(world: int, step: int) -> list[float]:
    """Random controls that follow from the numbers of world and step alone."""
    dice = np.random.default_rng((world, step // 15))
    return [dice.uniform(0.3, 1.0), dice.uniform(-0.3, 0.3), float(dice.uniform() < 0.1)]


def drive(worlds: Worlds, numbers: list[int], steps: int = STEPS) -> list[NDArray[Any]]:
    """Step the worlds, which have the controls of these numbers; returns each step's contacts."""
    met = []
    for step in range(steps):
        worlds.set_controls([controls_of(number, step) for number in numbers])
        worlds.set_walks([0.0, 1.0, 0.0], 1.4, slot=2)
        worlds.step()
        met.append(worlds.contacts.copy())
    return met


def of_world(contacts: NDArray[Any], number: int) -> NDArray[Any]:
    """The contacts of one world, as if it were the only one."""
    mine = contacts[contacts["world"] == number].copy()
    mine["world"] = 0
    return mine


def test_a_world_of_many_is_that_of_the_server_byte_for_byte(maps: MapLibrary) -> None:
    worlds, number = populated(maps, 3), 2
    server = World(maps.load(HOME_MAP), EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=0.05))
    for blueprint, pose in (
        (CAR, ahead(maps, 30, 0.0)),
        (SHUTTLE, ahead(maps, 30, 14.0)),
        (WALKER, ahead(maps, 30, -6.0, 0.6)),
        (CONE, ahead(maps, 30, 6.0)),
    ):
        server.spawn(ActorDescription(0, blueprint), Transform(Vector3D(*pose[:3]), Rotation(*pose[3:])))
    bodies, touched = server.episode.bodies, 0
    for step in range(STEPS):
        throttle, steer, brake = controls_of(number, step)
        bodies.set_control(0, VehicleControl(throttle, steer, brake))
        bodies.set_walker_control(2, WalkerControl(Vector3D(y=1.0), 1.4))
        server.step(0.05)
        worlds.set_controls([controls_of(each, step) for each in range(3)])
        worlds.set_walks([0.0, 1.0, 0.0], 1.4, slot=2)
        worlds.step()
        ours = of_world(worlds.contacts, number)
        assert ours.tobytes() == server.episode.contacts.tobytes()
        assert worlds.state[number].tobytes() == bodies.state[: bodies.count].tobytes()
        touched += len(ours)
    assert touched > 10  # the car met what stood before it
    assert worlds.elapsed_s[number] == server.elapsed_s
    assert worlds.light_colours[number].tobytes() == server.episode.traffic.state.colour.tobytes()


def test_worlds_stepped_together_are_those_stepped_one_by_one(maps: MapLibrary) -> None:
    count = 70  # two threads share them
    together, alone = populated(maps, count), [populated(maps, 1) for _ in range(count)]
    met = drive(together, list(range(count)))
    for number, worlds in enumerate(alone):
        own = drive(worlds, [number])
        assert worlds.state[0].tobytes() == together.state[number].tobytes()
        for all_contacts, contacts in zip(met, own, strict=True):
            assert of_world(all_contacts, number).tobytes() == contacts.tobytes()
    assert len({together.state[number].tobytes() for number in range(count)}) == count


def test_a_reset_brings_back_what_was_kept(maps: MapLibrary) -> None:
    worlds = populated(maps, 2)
    drive(worlds, [0, 1], 20)
    worlds.keep([1])
    kept = worlds.state[1].tobytes()
    drive(worlds, [0, 1], 20)
    worlds.reset()
    assert worlds.state[1].tobytes() == kept
    assert worlds.state[0].tobytes() == populated(maps, 1).state[0].tobytes()


def test_the_posted_limits_are_those_of_the_server(maps: MapLibrary) -> None:
    worlds = populated(maps, 2)
    server = World(maps.load(HOME_MAP), EpisodeSettings(synchronous_mode=True, fixed_delta_seconds=0.05))
    pose = ahead(maps, 30, 0.0)
    car = server.spawn(ActorDescription(0, CAR), Transform(Vector3D(*pose[:3]), Rotation(*pose[3:])))
    server.step(0.05)
    limits_kmh = np.full(2, 3.0)
    worlds.step()
    worlds.heed_limits(limits_kmh)
    row = server.episode.actors.rows.view(VEHICLE_ROW)[server.episode.actors.row(car.id)]
    assert limits_kmh == pytest.approx([row["speed_limit"]] * 2)
    worlds.place([5000.0, 5000.0, 300.0, 0.0, 0.0, 0.0])
    worlds.heed_limits(limits_kmh)
    assert limits_kmh == pytest.approx([row["speed_limit"]] * 2)  # off the road the last one holds
    with pytest.raises(UserError, match=r"limits_kmh needs an array \(2,\) of float64"):
        worlds.heed_limits(np.zeros(3))
    with pytest.raises(UserError, match="slot 2 of world 0 holds no vehicle"):
        worlds.heed_limits(limits_kmh, slot=2)


def test_the_number_of_threads_changes_nothing(maps: MapLibrary) -> None:
    one, all_of_them = populated(maps, 200, threads=1), populated(maps, 200)
    numbers = list(range(200))
    met, met_too = drive(one, numbers, 40), drive(all_of_them, numbers, 40)
    assert one.state.tobytes() == all_of_them.state.tobytes()
    assert [each.tobytes() for each in met] == [each.tobytes() for each in met_too]
    assert any(len(each) for each in met)


def test_a_world_that_is_reset_begins_anew_and_the_others_go_on(maps: MapLibrary) -> None:
    worlds = populated(maps, 3)
    first = [worlds.state[number].tobytes() for number in range(3)]
    drive(worlds, [0, 1, 2], 30)
    before = [worlds.state[number].tobytes() for number in range(3)]
    worlds.reset([1])
    assert [worlds.state[number].tobytes() for number in range(3)] == [before[0], first[1], before[2]]
    assert worlds.frames.tolist() == [30, 0, 30]
    assert 1 not in worlds.contacts["world"]
    colours = worlds.light_colours
    assert colours[1].tobytes() == Worlds(maps=maps).light_colours[0].tobytes()


def test_each_world_has_a_place_of_its_own_and_specifications_are_shared(maps: MapLibrary) -> None:
    worlds = Worlds(count=50, maps=maps)
    worlds.spawn(CAR, np.arange(50))
    points = np.array([[*p.location] for p in maps.load(HOME_MAP).spawn_points[:50]])
    assert worlds.poses[:, 0, :3] == pytest.approx(points)
    assert worlds.nbytes / worlds.count < 8000
    assert worlds.spawn(SHUTTLE, ahead(maps, 90, 0.0)) == 1
    assert {worlds.bodies(world).design(0) for world in range(50)} == {worlds.bodies(0).design(0)}
    assert worlds.bodies(49).spec(1)["wheelbase_m"] == pytest.approx(2.8)


def test_a_reset_brings_back_the_physics_of_the_spawn(maps: MapLibrary) -> None:
    worlds = Worlds(maps=maps)
    worlds.spawn(CAR, 30)
    bodies = worlds.bodies(0)
    drag = float(bodies.spec(0)["drag_kgpm"])
    for step in range(20):
        bodies.set_physics_control(0, bodies.physics_control(0)._replace(drag_coefficient=1.0 + step))
    worlds.reset()
    assert bodies.spec(0)["drag_kgpm"] == drag
    assert bodies.design(0).control.drag_coefficient == pytest.approx(0.23)


def test_some_worlds_get_actors_that_others_lack(maps: MapLibrary) -> None:
    worlds = Worlds(count=4, maps=maps)
    worlds.spawn(CAR, 30)
    worlds.spawn(SHUTTLE, 40, worlds=[1, 3])
    assert worlds.spawn(CAR, 50) == 2
    assert worlds.state["alive"].tolist() == [[True, False, True], [True, True, True]] * 2
    worlds.step()
    with pytest.raises(UserError, match="slot 1 of world 0 holds no vehicle"):
        worlds.set_controls([1.0, 0.0, 0.0], slot=1)
    worlds.clear([1])
    assert not worlds.state["alive"][1].any()


def test_a_lost_world_is_marked_and_stands_still_until_it_is_reset(maps: MapLibrary) -> None:
    worlds = Worlds(count=3, maps=maps)
    worlds.spawn(CAR, 30)
    worlds.place([FARTHEST_M - 10.0, 0.0, 1e4, 0.0, 0.0, 0.0], worlds=[1])
    worlds.set_velocity([1000.0, 0.0, 0.0], worlds=[1])
    for _ in range(3):
        worlds.step()
    assert worlds.valid.tolist() == [True, False, True]
    assert worlds.frames.tolist() == [3, 1, 3]
    worlds.reset([1])
    worlds.step()
    assert worlds.valid.all()
    assert worlds.frames.tolist() == [4, 1, 4]


class NoSpawnPoints:
    """A library with one map, which has no spawn points."""

    def __init__(self, maps: MapLibrary) -> None:
        self._map = dataclasses.replace(maps.load(HOME_MAP), spawn_points=())

    def load(self, _name: str) -> LoadedMap:
        return self._map


def test_a_map_without_spawn_points_needs_poses(maps: MapLibrary) -> None:
    worlds = Worlds(count=2, maps=NoSpawnPoints(maps))  # type: ignore[arg-type]
    with pytest.raises(UserError, match="has no spawn points; give poses"):
        worlds.spawn(CAR, 0)
    assert worlds.spawn(CAR, ahead(maps, 30, 0.0)) == 0


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"count": 0}, "count is a whole number from 1 to"),
        ({"count": 2.0}, "count is a whole number"),
        ({"count": True}, "count is a whole number"),
        ({"threads": -1}, "threads is a whole number"),
        ({"device": "tpu"}, "cannot run on device 'tpu'"),
        ({"dt_s": 0.0}, "dt_s is the time of a step"),
        ({"dt_s": float("nan")}, "dt_s is the time of a step"),
        ({"dt_s": "fast"}, "dt_s is the time of a step"),
    ],
)
def test_worlds_that_cannot_be_made_are_refused_with_a_sentence(options: dict[str, Any], sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        Worlds(**options)


def test_an_unknown_map_is_refused() -> None:
    with pytest.raises(Refusal, match="Map 'Nowhere' not found"):
        Worlds("Nowhere")


BAD: list[tuple[str, Callable[[Worlds], object], str]] = [
    ("nan", lambda w: w.set_controls([0.5, float("nan"), 0.0]), r"controls must be finite; at \(0, 1\) it is nan"),
    ("inf", lambda w: w.set_controls(np.full((3, 7), np.inf)), "controls must be finite"),
    ("shape", lambda w: w.set_controls(np.zeros((2, 3))), r"controls needs the shape \(3, 3\) or \(3,\), not \(2, 3\)"),
    ("width", lambda w: w.set_controls(np.zeros((3, 5))), "controls needs the shape"),
    ("text", lambda w: w.set_controls(["go", "left", "now"]), "controls must be numbers"),
    ("none", lambda w: w.set_controls(None), "controls must be numbers"),
    ("slot", lambda w: w.set_controls([1.0, 0.0, 0.0], slot=9), "slot is a whole number from 0 to"),
    ("walker", lambda w: w.set_controls([1.0, 0.0, 0.0], slot=2), "slot 2 of world 0 holds no vehicle"),
    ("car", lambda w: w.set_walks([1.0, 0.0, 0.0], 1.0), "slot 0 of world 0 holds no walker"),
    ("speed", lambda w: w.set_walks([1.0, 0.0, 0.0], np.nan, slot=2), "speeds_mps must be finite"),
    ("world", lambda w: w.reset([0, 3]), "there are 3 worlds, 0 to 2"),
    ("negative", lambda w: w.reset([-1]), "there are 3 worlds"),
    ("twice", lambda w: w.reset([1, 1]), "each world can be named once"),
    ("float", lambda w: w.reset([0.5]), "worlds are whole numbers"),
    ("empty", lambda w: w.reset([]), "worlds are whole numbers"),
    ("view", lambda w: w.bodies(3), "world is a whole number from 0 to 2"),
    ("blueprint", lambda w: w.spawn("vehicle.none", 0), "vehicle.none"),
    ("sensor", lambda w: w.spawn("sensor.other.gnss", 0), "has no body"),
    ("point", lambda w: w.spawn(CAR, 100_000), "has spawn points 0 to"),
    ("points", lambda w: w.spawn(CAR, [1, 2]), "at needs one spawn point or 3"),
    ("pose", lambda w: w.spawn(CAR, [1.0, 2.0]), "a pose .* needs the shape"),
    ("deep", lambda w: w.place([0.0, 0.0, -900.0, 0.0, 0.0, 0.0]), "below the ground"),
    ("room", lambda w: w.spawn(CAR, 30), "has no room at .* in world 0: the body in slot 0 stands there"),
    ("velocity", lambda w: w.set_velocity([np.nan, 0.0, 0.0]), "velocity_mps must be finite"),
]


@pytest.mark.parametrize(("call", "sentence"), [case[1:] for case in BAD], ids=[case[0] for case in BAD])
def test_bad_input_gets_a_sentence_and_leaves_the_worlds_as_they_were(
    maps: MapLibrary, call: Callable[[Worlds], object], sentence: str
) -> None:
    worlds = populated(maps, 3)
    before = worlds.state.tobytes()
    with pytest.raises(LindenError, match=sentence):
        call(worlds)
    assert worlds.state.tobytes() == before


def test_a_place_in_a_wall_is_refused(maps: MapLibrary) -> None:
    worlds = Worlds(maps=maps)
    bodies, statics = worlds.bodies(0), World(maps.load(HOME_MAP)).episode.statics
    x, y, z = statics.centre[len(statics.centre) // 2]
    with pytest.raises(UserError, match=r"static\.\w+ stands there"):
        worlds.spawn(CAR, [x, y, z, 0.0, 0.0, 0.0])
    assert bodies.count == 0


def test_the_package_gives_worlds() -> None:
    assert linden.Worlds is Worlds
    with pytest.raises(AttributeError, match="no attribute 'Planets'"):
        _ = linden.Planets
