"""Claims about what the road gives the tyres: by the weather, and inside friction triggers."""

import math

import pytest

from linden.maps.facts import derive
from linden.maps.library import LoadedMap
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.control import VehicleControl
from linden.protocol.values.enums import AttributeType
from linden.protocol.values.episode import WeatherParameters
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.simulation.actor_table import ActorRecord
from linden.simulation.friction import DRY, FRICTION_TRIGGER, PUDDLES, WET, road_friction
from linden.world import World
from opendrive_texts import street_through_junction

STREET = street_through_junction()
CAR = ActorDescription(0, "vehicle.tesla.model3")


@pytest.fixture
def simulation() -> World:
    return World(LoadedMap(name="street", text=STREET, **vars(derive(STREET))))


def at(x: float, z: float = 0.2) -> Transform:
    return Transform(Vector3D(x, 500.0, z), Rotation())


def trigger(simulation: World, x: float, friction: float, half_m: float = 2.0) -> ActorRecord:
    given = {"friction": friction, **{f"extent_{axis}": 100.0 * half_m for axis in "xyz"}}
    attributes = tuple(AttributeValue(name, AttributeType.FLOAT, str(value)) for name, value in given.items())
    return simulation.spawn(ActorDescription(0, FRICTION_TRIGGER, attributes), at(x))


def friction_of(simulation: World, vehicle: ActorRecord) -> float:
    return float(simulation.episode.bodies.friction_here[vehicle.slot])


@pytest.mark.parametrize(
    ("weather", "share"),
    [
        (WeatherParameters(), 1.0),
        (WeatherParameters(wetness=-1.0, precipitation_deposits=-1.0), 1.0),
        (WeatherParameters(precipitation=100.0), 1.0),
        (WeatherParameters(wetness=100.0), WET / DRY),
        (WeatherParameters(precipitation_deposits=100.0), PUDDLES / DRY),
        (WeatherParameters(precipitation_deposits=900.0), PUDDLES / DRY),
        (WeatherParameters(wetness=50.0), 0.5 * (1.0 + WET / DRY)),
        (WeatherParameters(wetness=100.0, precipitation_deposits=100.0), PUDDLES / DRY),
    ],
)
def test_the_wetter_the_road_the_less_it_grips(weather: WeatherParameters, share: float) -> None:
    assert road_friction(weather) == pytest.approx(share)


def test_every_vehicle_feels_the_weather_whenever_it_came(simulation: World) -> None:
    early = simulation.spawn(CAR, at(0.0))
    simulation.episode.weather = WeatherParameters(wetness=100.0)
    simulation.step(0.05)
    late = simulation.spawn(CAR, at(20.0))
    simulation.step(0.05)
    grips = simulation.episode.bodies.road_friction
    assert grips[early.slot] == grips[late.slot] == pytest.approx(WET / DRY)
    simulation.episode.weather = WeatherParameters()
    simulation.step(0.05)
    assert grips[early.slot] == grips[late.slot] == 1.0


def test_dry_roads_leave_every_bit_as_it_was(simulation: World) -> None:
    def outcome(weather: WeatherParameters) -> bytes:
        simulation.load(simulation.episode.map, reset_settings=False)
        simulation.episode.weather = weather
        car = simulation.spawn(CAR, at(0.0))
        simulation.episode.bodies.set_control(car.slot, VehicleControl(throttle=1.0, steer=0.3))
        for _ in range(40):
            simulation.step(0.05)
        return bytes(simulation.episode.bodies.state[car.slot].tobytes())

    dry = outcome(WeatherParameters())
    assert outcome(WeatherParameters(cloudiness=80.0, precipitation=50.0, fog_density=40.0)) == dry
    assert outcome(WeatherParameters(wetness=30.0)) != dry


def test_of_two_triggers_over_one_another_the_later_decides_until_it_goes(simulation: World) -> None:
    car = simulation.spawn(CAR, at(0.0))
    trigger(simulation, 0.0, 1.5)
    later = trigger(simulation, 1.0, 0.5)
    simulation.step(0.05)
    assert friction_of(simulation, car) == 0.5
    simulation.destroy(later.id)
    simulation.step(0.05)
    assert friction_of(simulation, car) == 1.5


def test_a_trigger_that_is_moved_takes_its_friction_along(simulation: World) -> None:
    car = simulation.spawn(CAR, at(0.0))
    moved = trigger(simulation, 30.0, 0.5)
    simulation.step(0.05)
    assert friction_of(simulation, car) < 0.0
    simulation.episode.place(moved.id, at(3.0))
    simulation.step(0.05)
    assert friction_of(simulation, car) == 0.5


def test_an_actor_in_the_slot_of_one_inside_a_trigger_is_inside_too(simulation: World) -> None:
    first = simulation.spawn(CAR, at(0.0))
    trigger(simulation, 0.0, 0.5)
    simulation.step(0.05)
    simulation.destroy(first.id)
    second = simulation.spawn(CAR, at(0.0))
    assert second.slot == first.slot
    assert friction_of(simulation, second) < 0.0
    simulation.step(0.05)
    assert friction_of(simulation, second) == 0.5


def test_a_car_that_rests_on_a_slope_slides_once_a_trigger_takes_its_grip(simulation: World) -> None:
    car = simulation.spawn(CAR, at(0.0))
    bodies = simulation.episode.bodies
    bodies.set_control(car.slot, VehicleControl(hand_brake=True))
    for _ in range(60):
        simulation.step(0.05)
    assert bodies.state["resting"][car.slot]
    trigger(simulation, 0.0, 0.0)
    bodies.add_impulse(car.slot, (1845.0, 0.0, 0.0))
    for _ in range(20):
        simulation.step(0.05)
    assert math.hypot(*bodies.velocity[car.slot, :2]) > 0.5
