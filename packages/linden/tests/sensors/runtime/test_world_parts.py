"""Parts of bodies in many worlds stand where matrix products of numpy put them, on any number of threads."""

import numpy as np
import pytest

from linden.blueprints.library import packaged
from linden.physics.bodies import Bodies
from linden.physics.columns import BodyTable
from linden.physics.state import VEHICLE, WALKER
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.scenery.actors.actor_meshes import actor_meshes
from linden.scenery.actors.posing import matrices, vehicle_frames, walker_frames
from linden.sensors.runtime import world_parts
from linden.sensors.runtime.visible_actors import PartRows
from linden.sensors.runtime.world_parts import PartsOfBodies, PlacedParts, parts_of_bodies, placed_parts
from linden.simulation.spawning import embody

WORLDS, SLOTS = 40, 4
ACTORS = ("vehicle.tesla.model3", "walker.pedestrian.0003", "static.prop.trafficcone01")


@pytest.fixture(scope="module")
def table() -> BodyTable:
    dice, made = np.random.default_rng(2), BodyTable(WORLDS, slots=SLOTS)
    for world in range(WORLDS):
        for name in ACTORS[: 1 + world % 3]:
            at = Transform(Vector3D(*dice.uniform(-50.0, 50.0, 3)), Rotation(*dice.uniform(-80.0, 80.0, 3)))
            embody(Bodies(made, world), packaged().find(name), packaged().validate(ActorDescription(0, name)), at)
    for name in ("velocity", "angular_velocity", "wheel_steer", "wheel_turned"):
        made.state[name] = dice.uniform(-2.0, 2.0, made.state[name].shape)
    return made


def placed(table: BodyTable, walked_m: np.ndarray) -> tuple[PartsOfBodies, PlacedParts]:
    world, slot = np.nonzero(table.state["alive"])
    designs = PartRows.of([packaged().validate(ActorDescription(0, name)) for name in ACTORS], actor_meshes())
    parts = parts_of_bodies(designs, world, (world * SLOTS + slot).astype(np.int32), slot, SLOTS, WORLDS)
    return parts, placed_parts(parts, table.state.reshape(-1), table.spec_of.reshape(-1), table.specs, walked_m)


def test_parts_stand_where_matrix_products_put_them(table: BodyTable) -> None:
    walked_m = np.random.default_rng(3).uniform(0.0, 3.0, WORLDS * SLOTS)
    parts, found = placed(table, walked_m)
    flat, spec_of = table.state.reshape(-1), table.spec_of.reshape(-1)
    assert parts.begins[-1] == len(parts.mesh) == parts.first[-1]
    for index, row in enumerate(parts.row.tolist()):
        body = flat[row]
        place = matrices(np.array([[*body["position"], *np.degrees(body["rotation"])]]))[0]
        frames = np.eye(4)[None, :3]
        if body["kind"] == VEHICLE:
            spec = table.specs[spec_of[row]]
            hubs = np.stack([spec[name] for name in ("wheel_x_m", "wheel_y_m", "wheel_radius_m")], -1)
            frames = vehicle_frames(hubs[None], body["wheel_steer"][None], body["wheel_turned"][None])[0]
        elif body["kind"] == WALKER:
            stature, speed = 2.0 * body["half_extent"][2], np.hypot(*body["velocity"][:2])
            frames = walker_frames(np.array([stature]), walked_m[[row]], np.array([speed]))[0]
        for part in range(parts.first[index], parts.first[index + 1]):
            inner = frames[parts.frame[part]]
            arm_m = place[:, :3] @ inner[:, 3]
            np.testing.assert_allclose(found.pose[part, :, :3], place[:, :3] @ inner[:, :3], atol=1e-6)
            np.testing.assert_allclose(found.pose[part, :, 3], place[:, 3] + arm_m, atol=1e-5)
            velocity = body["velocity"] + np.cross(body["angular_velocity"], arm_m)
            np.testing.assert_allclose(found.velocity_mps[part], velocity, atol=1e-6)
            np.testing.assert_allclose(found.turning_radps[part], body["angular_velocity"], rtol=1e-6)


def test_threads_change_no_byte(table: BodyTable, monkeypatch: pytest.MonkeyPatch) -> None:
    walked_m = np.zeros(WORLDS * SLOTS)
    _, one = placed(table, walked_m)
    monkeypatch.setattr(world_parts, "_FEWEST", 1)
    _, several = placed(table, walked_m)
    assert [column.tobytes() for column in one] == [column.tobytes() for column in several]


def test_each_world_has_its_parts_and_their_actors(table: BodyTable) -> None:
    parts, _ = placed(table, np.zeros(WORLDS * SLOTS))
    for world in range(WORLDS):
        own = parts.actor_id[parts.begins[world] : parts.begins[world + 1]]
        assert np.unique(own).tolist() == list(range(1, 2 + world % 3))
