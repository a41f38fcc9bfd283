"""Claims about sight in Linden: compared with the server's own rays, and from an agent in a run."""

import json
import math
import random
from pathlib import Path
from types import SimpleNamespace

import carla
import numpy as np

from basu.agents.sight import ActorKind, Other, Sight
from basu.agents.sight.occlusion import make_boxes, sample_points_m
from basu.cli import main
from servers import RunningServer

BOX = carla.BoundingBox(carla.Location(0.0, 0.0, 1.435), carla.Vector3D(2.01, 1.0, 1.435))
HALF_M = (0.2, 0.2, 0.9)
WATCHER = """
import json, math
import carla

class Watcher(AutonomousAgent):
    def setup(self):
        here = self.route.waypoints[0].transform.location
        self.walkers, self.known = [], []
        houses = self.world.get_level_bbs(carla.CityObjectLabel.Buildings)
        for house in sorted(houses, key=lambda house: house.location.distance(here))[:40]:
            at, reach_m = house.location, math.hypot(house.extent.x, house.extent.y) + 1.5
            away_m = math.hypot(at.x - here.x, at.y - here.y)
            beyond = 1.0 + reach_m / away_m
            place = carla.Location(here.x + beyond * (at.x - here.x), here.y + beyond * (at.y - here.y), at.z)
            if away_m > 12.0 and house.extent.z > 2.0 and (walker := self.spawned(place)) is not None:
                self.hidden = walker.id
                break
        ahead = self.route.waypoints[8].transform.location
        self.open = self.spawned(carla.Location(ahead.x, ahead.y, ahead.z + 1.2)).id

    def spawned(self, place):
        blueprint = self.world.get_blueprint_library().find("walker.pedestrian.0001")
        walker = self.world.try_spawn_actor(blueprint, carla.Transform(place))
        if walker is not None:
            self.walkers.append(walker)
        return walker

    def run_step(self, sensor_data):
        self.known.append([actor.id for actor in self.visible_actors()])
        if len(self.known) == 5:
            with open(FILE, "w") as file:
                json.dump({"hidden": self.hidden, "open": self.open, "known": self.known}, file)
            raise ValueError("enough")
        return carla.VehicleControl(brake=1.0)

    def config(self):
        return {}

    def destroy(self):
        for walker in self.walkers:
            walker.destroy()
"""


def test_a_body_that_the_servers_rays_reach_is_never_hidden(simulator: RunningServer) -> None:
    client = carla.Client("127.0.0.1", simulator.port)
    client.set_timeout(60.0)
    world = client.get_world()
    waypoints = [waypoint.transform for waypoint in world.get_map().generate_waypoints(8.0)]
    chance = random.Random(3)
    agreed_hidden = 0
    for pose in chance.sample(waypoints, 12):
        sight = Sight(world, SimpleNamespace(id=0, bounding_box=BOX))  # type: ignore[arg-type]
        near = [place for place in waypoints if 5.0 < place.location.distance(pose.location) < 75.0]
        others = [
            beside(number, place, chance.choice((0.0, 5.0, 9.0))) for number, place in enumerate(chance.sample(near, 8))
        ]
        sensor = carla.Location(*sight._sensor_m(pose).tolist())
        points = sample_points_m(make_boxes(np.array([(o.x_m, o.y_m, o.z_m, *HALF_M, o.yaw_rad) for o in others])))
        for seen, body in zip(sight._visible(others, pose), points.tolist(), strict=True):
            reached = any(is_free(world, sensor, carla.Location(*point)) for point in body)
            assert seen or not reached
            agreed_hidden += not seen
    assert agreed_hidden >= 5, "houses hide actors"


def beside(number: int, lane: carla.Transform, right_m: float) -> Other:
    """A walker on a lane, or so far to its right."""
    yaw_rad = math.radians(lane.rotation.yaw)
    x_m, y_m = lane.location.x - right_m * math.sin(yaw_rad), lane.location.y + right_m * math.cos(yaw_rad)
    return Other(number, ActorKind.WALKER, x_m, y_m, yaw_rad, 0.0, 0.0, 0.0, 0.2, 0.2, lane.location.z + 0.95, 0.9)


def is_free(world: carla.World, sensor: carla.Location, point: carla.Location) -> bool:
    """Whether the server's ray meets nothing before the point."""
    return all(hit.location.distance(point) < 0.3 for hit in world.cast_ray(sensor, point))


def test_a_users_agent_does_not_see_through_a_house(simulator: RunningServer, tmp_path: Path, route_file: Path) -> None:
    answer = tmp_path / "answer.json"
    agent = tmp_path / "watcher.py"
    agent.write_text(f"FILE = {str(answer)!r}\n{WATCHER}")
    address = ["--host", "127.0.0.1", "--port", str(simulator.port), "--agent-writes", str(tmp_path)]
    main(["run", str(agent), "--open", *address, "--routes", str(route_file), "--output", str(tmp_path / "runs")])
    told = json.loads(answer.read_text())
    assert all(told["open"] in known for known in told["known"][1:])
    assert not any(told["hidden"] in known for known in told["known"])
