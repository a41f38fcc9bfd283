"""Claims about cases for ScenarioRunner: of version 1.0, with a controller that follows their trajectories."""

import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import carla
import pytest
from lxml import etree

from basu.scenarios.stage import EGO
from basu_openscenario.exporting.case_export import SCENARIO_RUNNER, Exported
from basu_openscenario.exporting.timed_trajectory import COLLISIONS, COLLISIONS_END, TimedTrajectory
from fakes import asam

Write = Callable[[str], Path]

FRAME_S = 0.05
GAINS_MPS, WALKER_OFF_M = 0.4, 0.03
"""What a walker gains in a frame, and how far off it is then."""
CASES = ("red_light_runner_1", "cut_in_before_stop_1", "pedestrian_crossing_1", "static_object_1")


def all_of(where: Any, path: str) -> list[Any]:
    """Return the elements or attributes of a document that an XPath finds."""
    return list(where.xpath(path))


@pytest.fixture(scope="module")
def written(export_for: Callable[[str, str], tuple[Exported, Path]]) -> Write:
    """Writes a case of Linden for ScenarioRunner by its id, once."""
    return lambda name: export_for(name, SCENARIO_RUNNER)[1]


@pytest.mark.parametrize("name", CASES)
def test_a_case_is_of_the_version_that_it_takes(written: Write, name: str) -> None:
    path = written(name)
    document = etree.parse(path)
    assert asam.scenario_issues(path) == []
    assert document.find("FileHeader").get("revMinor") == "0"
    assert document.find(".//LogicFile").get("filepath") == "Linden"
    assert not path.with_name("Linden.xodr").exists()
    names = [one.get("name") for one in document.iter("Condition")]
    assert len(names) == len(set(names))


@pytest.mark.parametrize("name", CASES)
def test_each_actor_has_the_controller_beside_the_file(written: Write, name: str) -> None:
    path = written(name)
    actors = etree.parse(path).findall(".//Init/Actions/Private")
    assert EGO in {one.get("entityRef") for one in actors}
    for one in actors:
        (module,) = one.findall(".//Controller/Properties/Property[@name='module']")
        assert "class TimedTrajectory" in path.with_name(module.get("value")).read_text("utf-8")
        assert all(200.0 < float(place.get("z")) < 300.0 for place in one.iterfind(".//WorldPosition"))


def test_lights_are_named_by_their_places(written: Write) -> None:
    lights = etree.parse(written("red_light_runner_1")).findall(".//TrafficSignalStateAction")
    assert sorted(one.get("state") for one in lights) == ["Green", "Red", "Red", "Red"]
    assert all(one.get("name").startswith("pos=") for one in lights)


def test_a_departure_comes_some_time_after_a_mark(written: Write) -> None:
    """ScenarioRunner waits for a delay before it looks at a condition, so that the act begins with the mark itself."""
    document = etree.parse(written("cut_in_before_stop_1"))
    (leaving,) = all_of(document, "//Event[.//DeleteEntityAction]/StartTrigger//ParameterCondition/@parameterRef")
    (act,) = all_of(document, f"//Act[.//ParameterAction[@parameterRef='{leaving}']]")
    (begin,) = all_of(act, "StartTrigger//ParameterCondition[@parameterRef!='ended']/@parameterRef")
    (later,) = all_of(act, ".//Event/StartTrigger//Condition[number(@delay) > 1]")
    assert all_of(later, ".//ParameterCondition/@parameterRef") == [begin]


def test_each_mark_is_declared(written: Write) -> None:
    document = etree.parse(written("pedestrian_crossing_1"))
    declared = set(all_of(document, "//ParameterDeclaration/@name"))
    assert declared == set(all_of(document, "//ParameterCondition/@parameterRef"))
    assert declared == set(all_of(document, "//ParameterAction/@parameterRef"))


@pytest.mark.parametrize(
    ("name", "passed", "leaving"),
    [
        ("turn_into_traffic_1", {EGO}, set()),
        ("dynamic_object_1", set(), {"object"}),
        ("oncoming_overtaker_2", {EGO}, {"oncoming"}),
        ("backing_car_1", set(), set()),
    ],
)
def test_actors_that_meet_or_leave_the_roads_in_the_rehearsal_do_not_collide(
    written: Write, name: str, passed: set[str], leaving: set[str]
) -> None:
    """Others drive through the ego, a bicycle rolls into a house, and the overtaker rolls over a parking lane."""
    actors = etree.parse(written(name)).findall(".//Init/Actions/Private")
    having = {
        prop: {one.get("entityRef") for one in actors if one.findall(f".//Property[@name='{prop}']")}
        for prop in (COLLISIONS, COLLISIONS_END)
    }
    assert having == {COLLISIONS: passed, COLLISIONS_END: leaving}


class Actor:
    """An actor in a world whose frames have ``FRAME_S``, which moves by the transforms that it receives."""

    def __init__(self, kind: str) -> None:
        self.type_id, self.is_alive = kind, True
        self.place, self.frame = carla.Transform(), 0
        self.velocity, self.turn_deg_s = carla.Vector3D(), 0.0
        self.wanted = carla.Vector3D()
        self.collides = True

    def get_world(self) -> SimpleNamespace:
        now = SimpleNamespace(elapsed_seconds=self.frame * FRAME_S, delta_seconds=FRAME_S)
        return SimpleNamespace(get_snapshot=lambda: SimpleNamespace(timestamp=now))

    def get_transform(self) -> carla.Transform:
        return self.place

    def set_transform(self, place: carla.Transform) -> None:
        self.place = place

    def get_velocity(self) -> carla.Vector3D:
        return self.velocity

    def set_target_velocity(self, velocity: carla.Vector3D) -> None:
        self.velocity = velocity

    def set_target_angular_velocity(self, turn: carla.Vector3D) -> None:
        self.turn_deg_s = turn.z

    def get_control(self) -> carla.WalkerControl:
        return carla.WalkerControl()

    def apply_control(self, control: carla.WalkerControl) -> None:
        self.wanted = control.direction * control.speed

    def set_collisions(self, collides: bool) -> None:  # noqa: FBT001 - as the client has it
        self.collides = collides

    def tick(self) -> None:
        self.frame += 1
        if self.type_id.startswith("walker."):
            gain = self.wanted - self.velocity
            self.velocity += gain * min(1.0, GAINS_MPS / max(gain.length(), 1e-9))
        self.place.location += self.velocity * FRAME_S
        self.place.rotation.yaw += self.turn_deg_s * FRAME_S


@pytest.mark.parametrize("kind", ["vehicle.tesla.model3", "walker.pedestrian.0001", "static.prop.box01"])
def test_the_controller_is_at_each_point_at_its_time(kind: str) -> None:
    actor = Actor(kind)
    controller = TimedTrajectory(actor)
    controller.run_step()
    assert actor.velocity.length() == 0.0
    way = [(1.0, 0.0, 0.0), (3.0, 10.0, 0.0), (5.0, 10.0, 4.0)]
    controller.update_waypoints(
        [carla.Transform(carla.Location(x, y)) for _, x, y in way], [time_s for time_s, *_ in way]
    )
    off_m = WALKER_OFF_M if kind.startswith("walker.") else 0.01
    for time_s, x, y in way:
        while actor.frame * FRAME_S < time_s - 1e-6:
            controller.run_step()
            actor.tick()
        assert math.dist((actor.place.location.x, actor.place.location.y), (x, y)) < off_m
    assert controller.check_reached_waypoint_goal()
    for _ in range(20):
        controller.run_step()
        actor.tick()
    assert math.dist((actor.place.location.x, actor.place.location.y), way[-1][1:]) < off_m


def test_an_animal_that_gains_speed_slowly_keeps_up() -> None:
    """A deer of a rehearsal has 8 m/s at once; a walker of the server gains 0.4 m/s in a frame."""
    actor = Actor("walker.animal.deer")
    controller = TimedTrajectory(actor)
    controller.update_waypoints([carla.Transform(), carla.Transform(carla.Location(16.0, 0.0))], [0.0, 2.0])
    for _ in range(60):
        controller.run_step()
        actor.tick()
        assert abs(actor.place.location.x - min(8.0 * actor.frame * FRAME_S, 16.0)) < 0.05


def test_collisions_end_from_the_beginning_or_at_a_place() -> None:
    actor = Actor("vehicle.tesla.model3")
    TimedTrajectory(actor, {COLLISIONS: "false"})
    assert not actor.collides
    actor = Actor("vehicle.tesla.model3")
    controller = TimedTrajectory(actor, {COLLISIONS_END: "5.00,0.00"})
    controller.update_waypoints([carla.Transform(), carla.Transform(carla.Location(10.0, 0.0))], [0.0, 10.0])
    for _ in range(150):
        controller.run_step()
        assert actor.collides == (actor.place.location.x < 4.01)
        actor.tick()


def test_an_actor_that_was_blocked_does_not_jump() -> None:
    actor = Actor("vehicle.tesla.model3")
    controller = TimedTrajectory(actor)
    controller.update_waypoints([carla.Transform(), carla.Transform(carla.Location(50.0, 0.0))], [0.0, 10.0])
    for _ in range(100):
        controller.run_step()
        actor.frame += 1  # it is held for five seconds
    assert actor.velocity.length() == pytest.approx(5.0 + 2.0, abs=0.01)


def test_a_trajectory_without_times_is_refused() -> None:
    with pytest.raises(ValueError, match="needs a trajectory with times"):
        TimedTrajectory(Actor("vehicle.tesla.model3")).update_waypoints([carla.Transform()])
