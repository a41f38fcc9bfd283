"""Claims about the actors near the vehicle: things are recorded with their sizes, beside vehicles and walkers."""

from types import SimpleNamespace
from typing import Any

import carla
import pytest

from basu.managers.base_manager import Ego, Frame
from basu.managers.neighbours import SMALLEST_M, Neighbours

EGO = Ego(*[0.0] * 15)


def actor(key: int, type_id: str, x_m: float, *, z_m: float = 0.0, yaw_deg: float = 0.0, box: Any = None) -> Any:
    box = box or carla.BoundingBox(carla.Location(0.0, 0.0, 0.5), carla.Vector3D(1.0, 0.5, 0.5))
    pose = carla.Transform(carla.Location(x_m, 0.0, z_m), carla.Rotation(yaw=yaw_deg))
    return SimpleNamespace(
        id=key,
        type_id=type_id,
        bounding_box=box,
        get_transform=lambda: pose,
        get_velocity=carla.Vector3D,
    )


class Snapshot(dict[int, Any]):
    def find(self, key: int) -> Any:
        return self.get(key)


def near(*actors: Any) -> tuple[list[int], Neighbours]:
    """The ids of the rows for actors around an ego at the origin."""
    found = Neighbours(SimpleNamespace(get_actors=lambda: list(actors)), ego_id=1)
    frame: Any = Frame(0, 7, Snapshot({one.id: one for one in actors}), EGO)  # type: ignore[arg-type]
    return [int(row[1]) for row in found.near(frame)], found


def test_things_are_recorded_behind_vehicles_and_walkers_with_their_sizes() -> None:
    ids, found = near(
        actor(2, "static.prop.streetsign04", 5.0),
        actor(3, "walker.pedestrian.0001", 20.0),
        actor(4, "vehicle.audi.tt", 10.0),
    )
    assert ids == [4, 3, 2]
    assert found.met[2] == "static.prop.streetsign04"
    assert found.sizes[2] == (1.0, 0.5)


@pytest.mark.parametrize(
    "type_id", ["sensor.camera.rgb", "traffic.stop", "spectator", "static.trigger.friction", "controller.ai.walker"]
)
def test_what_stands_in_nobodys_way_is_not(type_id: str) -> None:
    assert near(actor(2, type_id, 5.0))[0] == []


def test_a_thing_that_hangs_overhead_is_not_until_it_comes_down() -> None:
    assert near(actor(2, "static.prop.streetsign04", 5.0, z_m=4.0))[0] == []
    assert near(actor(2, "static.prop.streetsign04", 5.0, z_m=1.0))[0] == [2]


def test_things_do_not_crowd_out_vehicles() -> None:
    props = [actor(10 + n, "static.prop.trafficcone01", 1.0 + 0.1 * n) for n in range(40)]
    assert 2 in near(actor(2, "vehicle.audi.tt", 50.0), *props)[0]


def test_the_place_is_that_of_the_boxs_middle() -> None:
    box = carla.BoundingBox(carla.Location(0.5, 0.0, 0.5), carla.Vector3D(1.0, 0.5, 0.5))
    found = Neighbours(SimpleNamespace(get_actors=lambda: [one]), ego_id=1)
    one = actor(2, "vehicle.audi.tt", 10.0, yaw_deg=90.0, box=box)
    frame: Any = Frame(0, 7, Snapshot({2: one}), EGO)  # type: ignore[arg-type]
    assert found.near(frame)[0][2:4] == pytest.approx((10.0, 0.5), abs=1e-6)


def test_an_empty_box_gets_a_size() -> None:
    box = carla.BoundingBox(carla.Location(), carla.Vector3D())
    assert near(actor(2, "static.prop.mesh", 5.0, box=box))[1].sizes[2] == (SMALLEST_M, SMALLEST_M)
