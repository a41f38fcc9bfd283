"""Claims about actions in a simulator, with tyres and walking animations."""

import math
from collections.abc import Iterator
from types import SimpleNamespace

import carla
import numpy as np
import pytest
from py_trees.common import Status

from basu import simulator as simulator_module
from basu.managers.stage.scenario_actors import ActorCommands
from basu.scenarios.actions import Brake, DriveAlong, LetGo, WalkAlong
from basu.scenarios.actions.one_frame import Action
from basu.scenarios.paths import Path, along_lane
from basu.scenarios.stage import ActorBox, Pose
from servers import RunningServer

STEP_S = 0.05


class OneActor:
    """As much of a stage as one actor needs."""

    step_s, ego_contacts = STEP_S, frozenset()

    def __init__(self, client: carla.Client, actor: carla.Actor) -> None:
        self.actor, self.commands, self.time_s = actor, ActorCommands(client), 0.0
        self.member = SimpleNamespace(actor=actor, name="led")
        self.seen: list[ActorBox] = []

    def is_there(self, _name: str) -> bool:
        return True

    def body(self, _name: str) -> ActorBox:
        pose, velocity, box = self.actor.get_transform(), self.actor.get_velocity(), self.actor.bounding_box
        yaw_rad = math.radians(pose.rotation.yaw)
        x_m = pose.location.x + box.location.x * math.cos(yaw_rad)
        y_m = pose.location.y + box.location.x * math.sin(yaw_rad)
        return ActorBox(x_m, y_m, pose.location.z, yaw_rad, velocity.x, velocity.y, box.extent.x, box.extent.y)

    def move(self, _name: str, *motion: float) -> None:
        self.commands.move(self.member, *motion)

    def walk(self, _name: str, *velocity: float) -> None:
        self.commands.walk(self.member, *velocity)

    def let_go(self, _name: str) -> None:
        self.commands.let_go(self.member)

    def play(self, action: Action, until_s: float = 60.0) -> None:
        """Until it is done."""
        action.setup(stage=self)
        for _ in range(round(until_s / STEP_S)):
            action.tick_once()
            self.go_on(1)
            if action.status == Status.SUCCESS:
                return
        raise AssertionError(f"'{action.name}' is not done after {until_s:g} s")

    def go_on(self, frames: int) -> None:
        for _ in range(frames):
            self.commands.carry_out()
            self.actor.get_world().tick()
            self.time_s += STEP_S
            self.seen.append(self.body(""))


@pytest.fixture
def client(simulator: RunningServer) -> Iterator[carla.Client]:
    """Of a fresh world that ticks with us."""
    client = simulator_module.connect("127.0.0.1", simulator.port, 60.0)
    world = client.get_world()
    if not world.get_map().name.endswith("Linden"):
        world = client.load_world("Linden")
    before = world.get_settings()
    world.apply_settings(carla.WorldSettings(synchronous_mode=True, fixed_delta_seconds=STEP_S))
    yield client
    world.apply_settings(before)


def on_stage(client: carla.Client, blueprint: str, pose: Pose) -> OneActor:
    """An actor that has come to rest at a pose."""
    world = client.get_world()
    at = carla.Transform(carla.Location(*pose[:2], pose.z_m + 0.6), carla.Rotation(yaw=math.degrees(pose.yaw_rad)))
    stage = OneActor(client, world.spawn_actor(world.get_blueprint_library().find(blueprint), at))
    stage.go_on(20)
    stage.seen.clear()
    return stage


def way_with_a_turn(town: carla.Map) -> Path:
    """Along a lane and round a corner."""
    for place in town.get_spawn_points():
        at = place.location
        path = along_lane(town, Pose(at.x, at.y, at.z, math.radians(place.rotation.yaw)), 75.0, ("left", "left"))
        if abs(path.yaw_rad[-1] - path.yaw_rad[0]) > 1.2 and path.length_m > 70.0:
            return path
    raise AssertionError("no street of Linden has a corner")


@pytest.mark.parametrize(
    ("blueprint", "speed_mps", "off_m"),
    [
        ("vehicle.lincoln.mkz_2020", 8.0, 0.15),
        ("vehicle.kawasaki.ninja", 8.0, 0.4),
    ],
)
def test_a_corner_is_driven_to_a_hands_breadth_with_the_speed_that_was_commanded(
    client: carla.Client, blueprint: str, speed_mps: float, off_m: float
) -> None:
    path = way_with_a_turn(client.get_world().get_map())
    stage = on_stage(client, blueprint, path.at(0.0))
    try:
        stage.play(DriveAlong("x", path, speed_mps))
        near = [path.nearest(body.x_m, body.y_m) for body in stage.seen]
        assert max(place.distance_m for place in near) < off_m
        cruising = [body.speed_mps for body, place in zip(stage.seen, near, strict=True) if 30.0 < place.s_m < 60.0]
        assert np.mean(cruising) == pytest.approx(speed_mps, rel=0.01)
        stage.go_on(20)
        end = stage.seen[-1]
        stage.go_on(20)
        assert math.dist(end[:2], stage.seen[-1][:2]) < 0.01  # held
        assert path.nearest(end.x_m, end.y_m).s_m == pytest.approx(path.length_m, abs=0.5)
    finally:
        stage.actor.destroy()


def test_braking_is_as_hard_as_commanded_and_one_that_is_let_go_rolls_on(client: carla.Client) -> None:
    path = way_with_a_turn(client.get_world().get_map())
    stage = on_stage(client, "vehicle.lincoln.mkz_2020", path.at(0.0))
    try:
        stage.play(DriveAlong("x", path, 8.0, to_m=20.0, at_end="go on"))
        stage.seen.clear()
        stage.play(Brake("x", 4.0, 3.0, path))
        change = np.diff([body.speed_mps for body in stage.seen]) / STEP_S
        assert np.median(change[3:-3]) == pytest.approx(-3.0, abs=0.3)
        stage.play(LetGo("x"))
        stage.go_on(20)
        assert 1.0 < stage.seen[-1].speed_mps < 4.1
    finally:
        stage.actor.destroy()


def test_a_walker_crosses_and_turns_back_to_where_it_stood(client: carla.Client) -> None:
    street = way_with_a_turn(client.get_world().get_map())
    begin, end = street.at(15.0, 3.0), street.at(15.0, -3.0)
    stage = on_stage(client, "walker.pedestrian.0001", begin)
    try:
        across = Path.through([begin[:3], end[:3]])
        stage.play(WalkAlong("x", across, 1.5, at_end="turn back"))
        assert stage.time_s - 1.0 == pytest.approx(2.0 * 6.0 / 1.5, abs=1.0)
        assert min(math.dist(body[:2], end[:2]) for body in stage.seen) < 0.3
        stage.go_on(10)
        assert math.dist(stage.seen[-1][:2], begin[:2]) < 0.3
        assert stage.seen[-1].speed_mps < 0.05
    finally:
        stage.actor.destroy()
