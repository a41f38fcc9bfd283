"""Tests of ``basu.agents.sight.line_of_sight``."""

import math
from collections.abc import Collection
from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu.agents.sight import MEMORY_S, RADIUS_M, ActorKind, Knowledge, Other, Sight
from basu.agents.sight.actors import LOOK_AGAIN_TICKS, SMALLEST_M
from basu.agents.sight.line_of_sight import (
    FAR_TICKS,
    LAMPS_M,
    LOW_BEAM_M,
    SUNSET_M,
    WEATHER_TICKS,
    air_range_m,
    light_range_m,
    ranges_m,
)
from basu.records.partners import Partner


def test_by_day_light_sets_no_limit() -> None:
    assert light_range_m(0.0, lamps=False) == light_range_m(45.0, lamps=True) == math.inf


@pytest.mark.parametrize(
    ("sun_deg", "unlit_m", "lamps_m"),
    [
        pytest.param(-1e-9, SUNSET_M, SUNSET_M, id="sunset"),
        pytest.param(-3.0, 96.4, 215.5, id="dusk"),
        pytest.param(-6.0, LOW_BEAM_M, LAMPS_M, id="end of civil twilight"),
        pytest.param(-90.0, LOW_BEAM_M, LAMPS_M, id="night"),
    ],
)
def test_the_range_falls_from_sunset_to_the_dark(sun_deg: float, unlit_m: float, lamps_m: float) -> None:
    assert light_range_m(sun_deg, lamps=False) == pytest.approx(unlit_m, abs=0.1)
    assert light_range_m(sun_deg, lamps=True) == pytest.approx(lamps_m, abs=0.1)


def test_contrast_falls_to_five_percent_at_the_optical_range() -> None:
    weather = carla.WeatherParameters(fog_density=100.0, fog_distance=0.0, precipitation=0.0)
    assert math.exp(-(0.07 + 1e-4) * air_range_m(weather)) == pytest.approx(0.05)
    assert air_range_m(weather) == pytest.approx(42.7, abs=0.1)


def test_fog_that_begins_farther_off_hides_less() -> None:
    near, far = (carla.WeatherParameters(fog_density=60.0, fog_distance=away_m) for away_m in (0.0, 30.0))
    assert air_range_m(far) - air_range_m(near) == pytest.approx(30.0)


def test_in_a_foggy_night_the_shorter_range_counts() -> None:
    weather = carla.WeatherParameters(cloudiness=10.0, fog_density=100.0, fog_distance=0.0, sun_altitude_angle=-90.0)
    assert ranges_m(weather) == (LOW_BEAM_M, pytest.approx(air_range_m(weather)))


def test_the_weather_that_is_left_to_the_map_is_a_clear_day() -> None:
    assert ranges_m(carla.WeatherParameters.Default) == (math.inf, math.inf)


AT_X_M, AT_Y_M = 100.0, 50.0
DAY = carla.WeatherParameters(cloudiness=10.0, sun_altitude_angle=45.0)
NIGHT = carla.WeatherParameters(cloudiness=10.0, sun_altitude_angle=-90.0)
STEP_S = 0.05


def actor(number: int, x_m: float, y_m: float, yaw_deg: float = 0.0) -> SimpleNamespace:
    """One actor of a snapshot."""
    return SimpleNamespace(
        id=number,
        get_transform=lambda: carla.Transform(carla.Location(x_m, y_m, 0.0), carla.Rotation(yaw=yaw_deg)),
        get_velocity=lambda: carla.Vector3D(3.0, 4.0, 0.0),
        get_angular_velocity=lambda: carla.Vector3D(0.0, 0.0, 90.0),
    )


class Snapshot(list[Any]):
    """A ``carla.WorldSnapshot`` as far as it is asked; the vehicle itself is actor 1."""

    def __init__(self, actors: list[Any], time_s: float = 0.0) -> None:
        super().__init__([actor(1, AT_X_M, AT_Y_M), *actors])
        self.timestamp = SimpleNamespace(elapsed_seconds=time_s)

    def find(self, number: int) -> Any:
        return next((one for one in self if one.id == number), None)


class World:
    """A ``carla.World`` as far as it is asked."""

    def __init__(self, *houses: tuple[float, float], weather: Any = DAY, **types: str) -> None:
        self.types = {int(key[1:]): value for key, value in types.items()}
        self.houses, self.weather = houses, weather
        self.questions: list[list[int]] = []
        self.asked_for_weather = 0

    def get_actors(self, ids: list[int]) -> list[Any]:
        self.questions.append(ids)
        box = carla.BoundingBox(carla.Location(0.5, 0.0, 0.7), carla.Vector3D(2.0, 0.9, 0.7))
        return [SimpleNamespace(id=i, type_id=self.types[i], bounding_box=box) for i in ids if i in self.types]

    def get_weather(self) -> carla.WeatherParameters:
        self.asked_for_weather += 1
        return self.weather

    def get_names_of_all_objects(self) -> list[str]:
        return [str(house) for house in self.houses]

    def get_environment_objects(self, label: Any) -> list[SimpleNamespace]:
        if str(label) != "Buildings":
            return []
        half = carla.Vector3D(2.0, 8.0, 3.0)
        boxes = [carla.BoundingBox(carla.Location(x, y, 3.0), half) for x, y in self.houses]
        return [SimpleNamespace(bounding_box=box) for box in boxes]


def sight_in(
    world: World,
    radius_m: float = RADIUS_M,
    knowledge: Knowledge = Knowledge.SEEN,
    blind_to: Collection[Partner] = (),
) -> Sight:
    """What the shuttle sees."""
    box = carla.BoundingBox(carla.Location(0.0, 0.0, 1.435), carla.Vector3D(2.01, 1.0, 1.435))
    return Sight(world, SimpleNamespace(id=1, bounding_box=box), radius_m, knowledge, blind_to)


def met(sight: Sight, *actors: SimpleNamespace, time_s: float = 0.0) -> list[Other]:
    """Those that are known in one tick."""
    return sight.others(Snapshot(list(actors), time_s))


def test_vehicles_walkers_and_props_are_seen_and_nothing_else() -> None:
    world = World(
        _2="vehicle.tesla.model3",
        _3="walker.pedestrian.0001",
        _4="static.prop.barrel",
        _5="traffic.stop",
        _6="sensor.camera.rgb",
    )
    others = met(sight_in(world), *(actor(i, 110.0, 50.0 + i) for i in (2, 3, 4, 5, 6)))
    assert [(other.id, other.kind) for other in others] == [
        (2, ActorKind.VEHICLE),
        (3, ActorKind.WALKER),
        (4, ActorKind.PROP),
    ]


@pytest.mark.parametrize("knowledge", [Knowledge.SEEN, Knowledge.FULL])
@pytest.mark.parametrize(
    ("kind", "number"),
    [(Partner.VEHICLE, 2), (Partner.WALKER, 3), (Partner.PROP, 4), (Partner.CYCLIST, 5), (Partner.ANIMAL, 6)],
)
def test_a_driver_blind_to_a_kind_sees_all_others(kind: Partner, number: int, knowledge: Knowledge) -> None:
    world = World(
        _2="vehicle.tesla.model3",
        _3="walker.pedestrian.0001",
        _4="static.prop.barrel",
        _5="vehicle.diamondback.century",
        _6="walker.animal.deer",
    )
    there = [actor(i, 110.0, 50.0 + 3.0 * i) for i in (2, 3, 4, 5, 6)]
    assert [other.id for other in met(sight_in(world, knowledge=knowledge), *there)] == [2, 3, 4, 5, 6]
    seen = met(sight_in(world, knowledge=knowledge, blind_to=[kind]), *there)
    assert [other.id for other in seen] == [other.id for other in there if other.id != number]


def test_an_actor_behind_a_house_is_not_seen_but_known_where_knowledge_is_full() -> None:
    world = World((120.0, 50.0), _2="vehicle.tesla.model3", _3="vehicle.tesla.model3")
    there = (actor(2, 140.0, 50.0), actor(3, 110.0, 50.0))
    assert [other.id for other in met(sight_in(world), *there)] == [3]
    assert [other.id for other in met(sight_in(world, knowledge=Knowledge.FULL), *there)] == [2, 3]


def test_an_actor_behind_another_is_not_seen() -> None:
    world = World(_2="vehicle.tesla.model3", _3="vehicle.tesla.model3")
    world.get_actors = lambda ids: [  # type: ignore[method-assign]
        SimpleNamespace(
            id=2,
            type_id="vehicle.bus",
            bounding_box=carla.BoundingBox(carla.Location(0, 0, 1.9), carla.Vector3D(5.0, 1.9, 1.9)),
        ),
        SimpleNamespace(
            id=3,
            type_id="vehicle.car",
            bounding_box=carla.BoundingBox(carla.Location(0, 0, 0.7), carla.Vector3D(2.0, 0.9, 0.7)),
        ),
    ]
    assert [other.id for other in met(sight_in(world), actor(2, 115.0, 50.0), actor(3, 124.0, 50.0))] == [2]


def test_at_night_a_walker_is_seen_in_the_low_beams_only_and_a_vehicle_by_its_lamps() -> None:
    kinds = {"_2": "walker.pedestrian.0001", "_3": "walker.pedestrian.0001", "_4": "vehicle.tesla.model3"}
    there = (actor(2, 125.0, 50.0), actor(3, 145.0, 53.0), actor(4, 160.0, 60.0))
    assert [other.id for other in met(sight_in(World(weather=NIGHT, **kinds)), *there)] == [2, 4]
    assert [other.id for other in met(sight_in(World(**kinds)), *there)] == [2, 3, 4]


def test_an_actor_out_of_sight_is_remembered_for_a_moment_where_it_would_be_by_now() -> None:
    sight = sight_in(World((120.0, 50.0), _2="vehicle.tesla.model3"))
    met(sight, actor(2, 110.0, 50.0))
    (remembered,) = met(sight, actor(2, 140.0, 50.0), time_s=1.0)
    assert (remembered.x_m, remembered.y_m, remembered.unseen_s) == pytest.approx((113.5, 54.0, 1.0))
    assert len(met(sight, actor(2, 140.0, 50.0), time_s=MEMORY_S)) == 1
    assert met(sight, actor(2, 140.0, 50.0), time_s=MEMORY_S + STEP_S) == []


def test_far_actors_are_looked_at_in_turn_and_what_was_seen_then_holds_meanwhile() -> None:
    world = World((120.0, 50.0), _2="vehicle.tesla.model3")
    sight = sight_in(world, 350.0)
    beside, behind = actor(2, 250.0, 150.0), actor(2, 250.0, 50.0)
    assert [len(met(sight, beside)) for _ in range(FAR_TICKS)] == [1] * FAR_TICKS
    unseen = [met(sight, behind, time_s=STEP_S * n)[0].unseen_s > 0.0 for n in range(1, FAR_TICKS + 1)]
    assert unseen.count(True) >= 1
    assert unseen[-1]


def test_nothing_that_is_seen_hangs_on_an_actors_id() -> None:
    def seen(first: int) -> list[list[float]]:
        numbers = range(first, first + 8)
        sight = sight_in(World((120.0, 50.0), **{f"_{n}": "vehicle.tesla.model3" for n in numbers}), 350.0)
        return [
            [other.x_m for other in met(sight, *(actor(n, 200.0 + 3 * tick, 40.0 + 9 * (n - first)) for n in numbers))]
            for tick in range(12)
        ]

    assert seen(2) == seen(103)


def test_an_actor_is_read_once() -> None:
    world = World(_2="vehicle.tesla.model3", _5="traffic.stop")
    sight = sight_in(world)
    for _ in range(3):
        met(sight, actor(2, 110.0, 50.0), actor(5, 110.0, 50.0))
    met(sight, actor(2, 110.0, 50.0), actor(5, 110.0, 50.0), actor(7, 110.0, 50.0))
    assert world.questions == [[2, 5], [7]]


def test_the_weather_is_read_again_now_and_then() -> None:
    world = World(_2="vehicle.tesla.model3")
    sight = sight_in(world)
    for _ in range(WEATHER_TICKS + 1):
        met(sight, actor(2, 110.0, 50.0))
    assert world.asked_for_weather == 2


def test_an_actor_that_comes_as_another_goes_is_seen_soon_and_one_that_is_gone_is_not_seen_at_all() -> None:
    sight = sight_in(World(_2="vehicle.tesla.model3", _3="vehicle.tesla.model3"))
    known = [[other.id for other in met(sight, actor(there, 110.0, 50.0))] for there in (2, *[3] * LOOK_AGAIN_TICKS)]
    assert known == [[2], *[[]] * (LOOK_AGAIN_TICKS - 1), [3]]


def test_actors_beyond_the_radius_are_left_out() -> None:
    world = World(_2="vehicle.tesla.model3", _3="vehicle.tesla.model3")
    there = (actor(2, AT_X_M + RADIUS_M + 1.0, 50.0), actor(3, 100.0, AT_Y_M + RADIUS_M - 1.0))
    assert [other.id for other in met(sight_in(world), *there)] == [3]


def test_the_box_is_seen_where_it_is_and_as_it_moves() -> None:
    (other,) = met(sight_in(World(_2="vehicle.tesla.model3")), actor(2, 110.0, 50.0, 90.0))
    assert (other.x_m, other.y_m, other.z_m) == pytest.approx((110.0, 50.5, 0.7))
    assert (other.half_length_m, other.half_width_m, other.half_height_m) == pytest.approx((2.0, 0.9, 0.7))
    assert other.speed_mps == pytest.approx(5.0)
    assert other.yaw_rate_radps == pytest.approx(math.pi / 2)


def test_a_body_without_a_box_has_some_size_all_the_same() -> None:
    world = World()
    bare = SimpleNamespace(id=4, type_id="static.prop.mesh", bounding_box=carla.BoundingBox())
    world.get_actors = lambda _ids: [bare]  # type: ignore[method-assign]
    assert met(sight_in(world), actor(4, 110.0, 50.0))[0].half_width_m == SMALLEST_M


def test_before_its_first_tick_a_vehicle_sees_no_actor() -> None:
    snapshot = Snapshot([])
    snapshot.clear()
    assert sight_in(World()).others(snapshot) == []
