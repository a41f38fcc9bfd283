"""A street with a light, a sign, two cars and a walker, driven for some frames: to try recorder and replayer on."""

import math
from collections.abc import Callable
from pathlib import Path

from linden.maps.facts import derive
from linden.maps.library import LoadedMap
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.control import VehicleControl, WalkerControl
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.simulation.actor_table import ActorRecord
from linden.world import World
from opendrive_texts import signal, street_through_junction

STEP_S = 0.05
SIGNALS = signal("7", 30.0, -5.0, "1000001") + signal("8", 10.0, -5.0, "274")
HERO, OTHER, WALKER, IMU = "vehicle.tesla.model3", "vehicle.audi.tt", "walker.pedestrian.0001", "sensor.other.imu"


def street(name: str = "street") -> LoadedMap:
    text = street_through_junction(signals=SIGNALS)
    return LoadedMap(name=name, text=text, **vars(derive(text)))


def spawned(
    simulation: World, type_id: str, pose: Transform, parent_id: int = 0, role: str = "autopilot"
) -> ActorRecord:
    attributes = (AttributeValue("role_name", 4, role),)
    return simulation.spawn(ActorDescription(0, type_id, attributes), pose, parent_id=parent_id)


class Drive:
    """The cast on the street; every frame is another."""

    def __init__(self, world_map: LoadedMap | None = None) -> None:
        self.simulation = World(world_map or street())
        lane = self.simulation.spawn_points[0]
        ahead = math.radians(lane.rotation.yaw)

        def along(forward_m: float, side_m: float, up_m: float = 0.3) -> Transform:
            x = lane.location.x + forward_m * math.cos(ahead) - side_m * math.sin(ahead)
            y = lane.location.y + forward_m * math.sin(ahead) + side_m * math.cos(ahead)
            return Transform(Vector3D(x, y, lane.location.z + up_m), Rotation(0.0, lane.rotation.yaw, 0.0))

        self.along = along
        self.hero = spawned(self.simulation, HERO, along(0.0, 0.0), role="hero")
        self.other = spawned(self.simulation, OTHER, along(12.0, 0.0))
        self.walker = spawned(self.simulation, WALKER, along(6.0, 3.0, 1.2))
        self.imu = spawned(self.simulation, IMU, Transform(Vector3D(1.0, 0.0, 2.0)), self.hero.id)

    def step(self, count: int, meanwhile: Callable[[int], None] = lambda _: None) -> None:
        """Drive on; ``meanwhile`` is called with each frame's number before it is made."""
        bodies = self.simulation.episode.bodies
        for n in range(count):
            meanwhile(n)
            if self.hero.id in self.simulation.episode.actors:
                bodies.set_control(self.hero.slot, VehicleControl(throttle=0.4, steer=0.02 * math.sin(0.3 * n)))
                bodies.set_control(self.other.slot, VehicleControl(throttle=0.6))
                bodies.set_walker_control(self.walker.slot, WalkerControl(Vector3D(1.0, 0.0, 0.0), 1.5))
            self.simulation.step(STEP_S)

    def record(self, path: Path, *, additional_data: bool = True) -> None:
        """Begin to record; the clock stands at 1,700,000,000 and goes on by a quarter of a second each time."""
        times = iter(range(10**9))
        recorder, name = self.simulation.recorder, self.simulation.map_name
        recorder.start(
            path,
            self.simulation.episode,
            name,
            lambda: 1_700_000_000 + next(times) / 4.0,
            additional_data=additional_data,
        )

    def rows(self, *actor_ids: int) -> list[bytes]:
        """The bytes of some actors' rows in the last snapshot, up to the end of location and rotation."""
        actors = self.simulation.episode.actors
        return [actors.rows[actors.row(actor_id)].tobytes()[:29] for actor_id in actor_ids]
