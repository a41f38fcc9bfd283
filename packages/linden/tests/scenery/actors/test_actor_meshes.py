"""Actors are seen as large as their boxes say, closed, with lamps, tags and colours where they belong."""

import numpy as np
import pytest

from linden.blueprints.library import ANIMALS, BlueprintKind, BlueprintLibrary
from linden.protocol.values.actors import ActorDescription
from linden.protocol.values.enums import SemanticTag
from linden.scenery.actors.actor_meshes import SCALED, actor_meshes
from linden.scenery.actors.posing import WALKER_FRAMES, vehicle_frames, walker_frames
from linden.scenery.mesh import LampOf, Material, Mesh, join
from linden.sensors.casting.caster import Instances, Rays
from linden.sensors.casting.choose import caster_of

LIBRARY = BlueprintLibrary.load()
VISIBLE = [b for b in LIBRARY if b.kind in (BlueprintKind.VEHICLE, BlueprintKind.WALKER, BlueprintKind.PROP)]
VEHICLES = [b for b in VISIBLE if b.kind is BlueprintKind.VEHICLE]
PEOPLE = [b for b in VISIBLE if b.definition.id.startswith("walker.pedestrian.")]
CARS = [b for b in VEHICLES if len(b.vehicle.wheel_offsets_m) == 4]
EMPTY = join([])


@pytest.fixture(scope="module")
def bodies():
    return actor_meshes()


def description(blueprint_id, **chosen):
    asked = LIBRARY.validate(ActorDescription(0, blueprint_id, ()))
    attributes = tuple(a._replace(value=chosen.get(a.id, a.value)) for a in asked.attributes)
    return asked._replace(attributes=attributes)


def frames_of(blueprint):
    """Where the parts are when the actor stands still."""
    if blueprint.kind is BlueprintKind.VEHICLE:
        hubs = np.zeros((1, 4, 3))
        hubs[0, : len(blueprint.vehicle.wheel_offsets_m)] = blueprint.vehicle.wheel_offsets_m
        return vehicle_frames(hubs, np.zeros((1, 4)), np.zeros((1, 4)))[0]
    if blueprint.kind is BlueprintKind.WALKER and not blueprint.definition.id.startswith(ANIMALS):
        return walker_frames(np.array([2.0 * blueprint.box.extent.z]), np.zeros(1), np.zeros(1))[0]
    return np.eye(4)[None, :3]


def whole(bodies, blueprint, **chosen):
    """The actor as one mesh in its own frame."""
    frames, placed = frames_of(blueprint), []
    for part in bodies.parts(description(blueprint.definition.id, **chosen)):
        mesh, frame = bodies.meshes[part.mesh], frames[part.frame]
        vertices = part.scale * mesh.vertices_m @ frame[:, :3].T + frame[:, 3]
        placed.append(mesh._replace(vertices_m=vertices.astype(np.float32)))
    return join(placed)


def lamp_places(mesh: Mesh, lamp: LampOf):
    """The middles of the triangles of a lamp."""
    shining = mesh.triangles[mesh.faces["lamp"] == lamp]
    return mesh.vertices_m[shining].mean(1)


@pytest.mark.parametrize("blueprint", VISIBLE, ids=lambda b: b.definition.id)
def test_a_body_is_as_long_and_wide_and_high_as_its_box_within_2_cm(bodies, blueprint):
    mesh = whole(bodies, blueprint)
    middle, half = np.array(blueprint.box.location), np.array(blueprint.box.extent)
    low, high = mesh.vertices_m.min(0), mesh.vertices_m.max(0)
    assert high[2] == pytest.approx(middle[2] + half[2], abs=0.02)
    if blueprint in PEOPLE:  # arms and feet reach out of the box, which is a capsule's
        assert low[2] == pytest.approx(-half[2], abs=0.02)
        return
    np.testing.assert_allclose(low[:2], (middle - half)[:2], atol=0.02)
    np.testing.assert_allclose(high[:2], (middle + half)[:2], atol=0.02)
    # CARLA's boxes of some cars reach into the ground or end above it; wheels stand on it
    assert low[2] == pytest.approx(0.0, abs=0.01) or low[2] == pytest.approx((middle - half)[2], abs=0.02)


@pytest.mark.parametrize("blueprint", VISIBLE, ids=lambda b: b.definition.id)
def test_a_look_from_outside_never_sees_the_inside(bodies, blueprint):
    mesh = whole(bodies, blueprint)
    caster = caster_of(mesh, [])
    caster.pose(nobody())
    random = np.random.default_rng(7)
    low, high = mesh.vertices_m.min(0), mesh.vertices_m.max(0)
    away = random.normal(size=(400, 3))
    start = 0.5 * (low + high) + away / np.linalg.norm(away, axis=1, keepdims=True) * np.linalg.norm(high - low)
    towards = random.uniform(low, high, (400, 3)) - start
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    hits = caster.closest(Rays(start.astype(np.float32), towards.astype(np.float32)), 1000.0)
    met = np.isfinite(hits.distance_m)
    assert met.any()
    assert ((hits.normal[met] * towards[met]).sum(1) < 1e-3).all()


def nobody():
    none = np.zeros((0, 3, 4), np.float32)
    vectors = np.zeros((0, 3), np.float32)
    numbers = np.zeros(0, np.uint32)
    return Instances(numbers.astype(np.int32), none, none, numbers, vectors.astype(np.uint8), numbers, vectors, vectors)


@pytest.mark.parametrize("blueprint", VISIBLE, ids=lambda b: b.definition.id)
def test_every_face_has_a_tag_of_its_blueprint(bodies, blueprint):
    tags = set(whole(bodies, blueprint).faces["tag"].tolist())
    assert tags == set(blueprint.semantic_tags or bytes([SemanticTag.STATIC]))


@pytest.mark.parametrize("blueprint", VEHICLES, ids=lambda b: b.definition.id)
def test_a_vehicle_is_drawn_with_a_few_thousand_triangles_and_shows_its_colour(bodies, blueprint):
    faces = whole(bodies, blueprint).faces
    assert 1000 < len(faces) < 3500
    painted = faces["painted"]
    assert painted.any()
    if blueprint in CARS:
        assert set(faces["material"][painted].tolist()) == {Material.CAR_PAINT}


@pytest.mark.parametrize("blueprint", CARS, ids=lambda b: b.definition.id)
def test_lamps_of_a_car_are_where_the_law_wants_them(bodies, blueprint):
    mesh, middle_m = whole(bodies, blueprint), blueprint.box.location.x
    for lamp, ahead in ((LampOf.HEAD, True), (LampOf.TAIL, False), (LampOf.REVERSE, False)):
        places = lamp_places(mesh, lamp)
        assert len(places)
        assert ((places[:, 0] > middle_m) == ahead).all()
        assert places[:, 1].min() < 0.0 < places[:, 1].max()
    for lamp, side in ((LampOf.BLINKER_LEFT, -1.0), (LampOf.BLINKER_RIGHT, 1.0)):
        places = lamp_places(mesh, lamp)
        assert (places[:, 1] * side > 0.0).all()
        assert places[:, 0].min() < middle_m < places[:, 0].max()


@pytest.mark.parametrize("blueprint", VEHICLES, ids=lambda b: b.definition.id)
def test_beacons_are_on_emergency_vehicles_alone(bodies, blueprint):
    special = next(a.value for a in blueprint.definition.attributes if a.id == "special_type")
    assert bool(len(lamp_places(whole(bodies, blueprint), LampOf.BEACON))) == (special == "emergency")


@pytest.mark.parametrize("blueprint", VEHICLES, ids=lambda b: b.definition.id)
def test_a_wheel_is_round_about_its_hub_so_that_it_can_roll(bodies, blueprint):
    parts = bodies.parts(description(blueprint.definition.id))
    wheels = [part for part in parts if 1 <= part.frame <= 4]
    assert len(wheels) == len(blueprint.vehicle.wheel_offsets_m)
    for part in wheels:
        vertices = bodies.meshes[part.mesh].vertices_m
        radius_m = blueprint.vehicle.wheel_offsets_m[part.frame - 1].z
        assert np.hypot(vertices[:, 0], vertices[:, 2]).max() == pytest.approx(radius_m, abs=0.005)


@pytest.mark.parametrize("blueprint", PEOPLE, ids=lambda b: b.definition.id)
def test_a_walker_has_a_part_for_every_bone_that_moves(bodies, blueprint):
    parts = bodies.parts(description(blueprint.definition.id))
    assert {part.frame for part in parts} == set(range(1, len(WALKER_FRAMES)))
    assert len({part.colour for part in parts}) == 2  # shirt and trousers


def test_limbs_that_meet_in_the_middle_of_a_step_do_not_come_apart(bodies):
    parts = {WALKER_FRAMES[p.frame]: p for p in bodies.parts(description("walker.pedestrian.0002"))}
    for walked_m in np.linspace(0.0, 1.5, 7):
        frames = walker_frames(np.array([1.86]), np.array([walked_m]), np.array([1.5]))[0]
        for upper, lower in (("crl_thigh__L", "crl_leg__L"), ("crl_arm__R", "crl_foreArm__R")):
            knee = frames[WALKER_FRAMES.index(lower), :, 3]
            for name in (upper, lower):
                frame = frames[WALKER_FRAMES.index(name)]
                vertices = bodies.meshes[parts[name].mesh].vertices_m @ frame[:, :3].T + frame[:, 3]
                assert np.linalg.norm(vertices - knee, axis=1).min() < 0.09


def test_riders_differ_by_driver_and_share_the_machine(bodies):
    first, second = (bodies.parts(description("vehicle.yamaha.yzf", driver_id=n)) for n in "12")
    assert {part.mesh for part in first} & {part.mesh for part in second}
    assert {part.mesh for part in first} != {part.mesh for part in second}


def test_a_wheelchair_user_sits_lower_and_is_as_much_a_pedestrian(bodies):
    blueprint = LIBRARY.find("walker.pedestrian.0001")
    sitting = whole(bodies, blueprint, use_wheelchair="true")
    assert 1.1 < sitting.vertices_m[:, 2].max() + blueprint.box.extent.z < 1.5
    assert sitting.vertices_m[:, 2].min() == pytest.approx(-blueprint.box.extent.z, abs=0.02)
    assert set(sitting.faces["tag"].tolist()) == {SemanticTag.PEDESTRIANS}


def test_a_mesh_of_unreals_is_a_cube_of_the_given_size(bodies):
    mesh = whole(bodies, LIBRARY.find(SCALED), scale="3.0")
    assert (mesh.vertices_m.max(0) - mesh.vertices_m.min(0)).tolist() == [3.0, 3.0, 3.0]


def test_what_cannot_be_seen_has_no_parts(bodies):
    assert bodies.parts(description("sensor.other.gnss")) == ()
    assert bodies.parts(description("controller.ai.walker")) == ()


def test_an_animal_is_one_part_with_the_tag_of_what_moves(bodies):
    for name in ("deer", "dog"):
        (part,) = bodies.parts(description(f"{ANIMALS}{name}"))
        assert part.frame == 0
        assert set(bodies.meshes[part.mesh].faces["tag"].tolist()) == {SemanticTag.DYNAMIC}
