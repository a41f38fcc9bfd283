"""Every caster against the obvious one, on scenes that are drawn at random."""

import importlib.util
from functools import cache, partial

import numpy as np
import pytest

from fakes.plain_caster import PlainCaster
from fakes.solids import at, box, floor, instances
from linden.errors import UserError
from linden.geometry import rotation_matrix
from linden.protocol.values.space import Rotation
from linden.scenery.mesh import Material, Mesh, faces, join
from linden.sensors.casting import embree_library
from linden.sensors.casting.caster import NOTHING, STATIC, Rays
from linden.sensors.casting.choose import caster_of, check_device
from linden.sensors.casting.embree import EmbreeCaster
from linden.sensors.casting.embreex_caster import EmbreexCaster

CASTERS = [EmbreeCaster, EmbreexCaster]
if importlib.util.find_spec("warp") is not None:  # the extra gpu; Warp's own processor will do
    from linden.sensors.casting.warp_caster import WarpCaster

    CASTERS.append(partial(WarpCaster, device="cpu"))


def rubble(dice: np.random.Generator, count: int, spread_m: float) -> Mesh:
    corners = dice.uniform(-spread_m, spread_m, (count, 1, 3)) + dice.uniform(-2.0, 2.0, (count, 3, 3))
    return Mesh(
        corners.reshape(-1, 3).astype(np.float32),
        np.arange(3 * count, dtype=np.uint32).reshape(-1, 3),
        faces(count, Material.PLAIN, 3, (1, 1, 1)),
    )


def rays_through(dice: np.random.Generator, count: int) -> Rays:
    direction = dice.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return Rays(dice.uniform(-8.0, 8.0, (count, 3)).astype(np.float32), direction.astype(np.float32))


def drawn(dice: np.random.Generator, count: int):
    turns = [rotation_matrix(Rotation(*dice.uniform(-180.0, 180.0, 3))) for _ in range(count)]
    places = dice.uniform(-6.0, 6.0, (count, 3))
    return instances(*((k % 2, 100 + k, at(*places[k], turns[k])) for k in range(count)))


def agree(found, expected) -> None:
    assert np.array_equal(np.isfinite(found.distance_m), np.isfinite(expected.distance_m))
    met = np.isfinite(expected.distance_m)
    np.testing.assert_allclose(found.distance_m[met], expected.distance_m[met], rtol=1e-5, atol=1e-4)
    assert np.array_equal(found.instance, expected.instance)
    assert np.array_equal(found.triangle, expected.triangle)
    np.testing.assert_allclose(found.normal, expected.normal, atol=1e-5)


@cache
def scene(seed: int):
    """Return what stands, the bodies, where they are, the rays, and the obvious caster."""
    dice = np.random.default_rng(seed)
    standing, bodies = rubble(dice, 90, 6.0), [rubble(dice, 20, 2.0), box((1.5, 0.8, 0.5))]
    bodies_there, rays = drawn(dice, 9), rays_through(dice, 301)
    plain = PlainCaster(standing, bodies)
    plain.pose(bodies_there)
    return standing, bodies, bodies_there, rays, plain


@cache
def obvious_hits(seed: int, *, outer: bool):
    *_, rays, plain = scene(seed)
    return plain.closest(rays, 25.0, outer=outer)


@cache
def obviously_blocked(seed: int):
    *_, rays, plain = scene(seed)
    return plain.blocked(rays, 25.0)


@pytest.mark.parametrize("kind", CASTERS)
@pytest.mark.parametrize("outer", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_it_answers_as_the_obvious_caster_does(kind, *, outer: bool, seed: int) -> None:
    standing, bodies, bodies_there, rays, _ = scene(seed)
    caster, expected = kind(standing, bodies), obvious_hits(seed, outer=outer)
    caster.pose(bodies_there)
    assert np.count_nonzero(expected.instance == STATIC) > 30
    assert np.count_nonzero(expected.instance >= 0) > 10
    agree(caster.closest(rays, 25.0, outer=outer), expected)
    agree(caster.closest(rays, 25.0, coherent=True, outer=outer), expected)
    assert np.array_equal(caster.blocked(rays, 25.0), obviously_blocked(seed))


@pytest.mark.parametrize("kind", CASTERS)
def test_bodies_are_where_they_were_posed_last_however_many_there_are(kind) -> None:
    caster = kind(floor(), [box((1.0, 1.0, 1.0)), box((2.0, 2.0, 2.0))])
    down = Rays(np.float32([[0, 0, 9], [20, 0, 9], [40, 0, 9]]), np.tile(np.float32([0, 0, -1]), (3, 1)))
    assert caster.closest(down, 50.0).instance.tolist() == [STATIC] * 3
    caster.pose(instances((0, 1, at(0, 0, 0)), (1, 2, at(20, 0, 0)), (0, 3, at(40, 0, 0))))
    assert caster.closest(down, 50.0).distance_m.tolist() == pytest.approx([8.0, 7.0, 8.0])
    caster.pose(instances((1, 2, at(40, 0, 0))))
    assert caster.closest(down, 50.0).instance.tolist() == [STATIC, STATIC, 0]
    caster.pose(instances((1, 2, at(40, 0, 0)), (1, 9, at(0, 0, 0))))
    assert caster.closest(down, 50.0).instance.tolist() == [1, STATIC, 0]
    caster.pose(instances())
    assert caster.closest(down, 50.0).instance.tolist() == [STATIC] * 3


@pytest.mark.parametrize("kind", CASTERS)
def test_nothing_stands_and_nothing_moves_is_a_world_too(kind) -> None:
    caster = kind(join([]), [])
    caster.pose(instances())
    down = Rays(np.float32([[0, 0, 9]]), np.float32([[0, 0, -1]]))
    assert caster.closest(down, 50.0).instance.tolist() == [NOTHING]
    assert not caster.blocked(down, 50.0).any()


@pytest.mark.parametrize("kind", CASTERS)
def test_a_larger_body_is_met_sooner_and_its_normals_have_length_1(kind) -> None:
    caster = kind(join([]), [box((1.0, 1.0, 1.0))])
    caster.pose(instances((0, 1, at(0, 0, 0, 3.0 * np.eye(3)))))
    hits = caster.closest(Rays(np.float32([[0, 0, 9]]), np.float32([[0, 0, -1]])), 50.0)
    assert hits.distance_m[0] == pytest.approx(6.0)
    assert hits.normal[0].tolist() == [0.0, 0.0, 1.0]


def test_a_second_caster_gives_the_same_bytes_whatever_the_stretches(monkeypatch: pytest.MonkeyPatch) -> None:
    dice = np.random.default_rng(5)
    standing, bodies = rubble(dice, 400, 12.0), [rubble(dice, 50, 2.0)]
    rays = rays_through(dice, 4_001)
    first = EmbreeCaster(standing, bodies).closest(rays, 60.0)
    monkeypatch.setattr("linden.sensors.casting.thread_pool.processors", lambda: 1)
    second = EmbreeCaster(standing, bodies).closest(rays, 60.0)
    for one, other in zip(first, second, strict=True):
        assert one.tobytes() == other.tobytes()


def test_no_ray_slips_between_the_triangles_of_a_floor() -> None:
    side = np.arange(65) * np.float32(1.7)
    x, y = np.meshgrid(side, side)
    corners = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)]).astype(np.float32)
    low = (np.arange(64)[:, None] * 65 + np.arange(64)).ravel()
    triangles = np.concatenate([[low, low + 1, low + 66], [low, low + 66, low + 65]], 1).T.astype(np.uint32)
    caster = EmbreeCaster(Mesh(corners, triangles, faces(len(triangles), Material.PLAIN, 1, (1, 1, 1))), [])
    down = np.tile(np.float32([0, 0, -1]), (len(corners), 1))
    inside = (corners[:, :2] > 0.0).all(1) & (corners[:, :2] < 64 * 1.7).all(1)
    onto_corners = Rays(corners[inside] + np.float32([0, 0, 30]), down[inside])
    assert np.isfinite(caster.closest(onto_corners, 50.0).distance_m).all()


def test_where_embree_cannot_be_loaded_another_caster_answers_and_says_why(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def lacking():
        raise embree_library.NoEmbreeError("there is no libembree4 here")

    monkeypatch.setattr("linden.sensors.casting.embree.embree", lacking)
    assert isinstance(caster_of(floor(), []), EmbreexCaster)
    assert "there is no libembree4 here" in caplog.text


def test_an_unknown_version_of_embree_is_not_called(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(embree_library, "_KNOWN_VERSIONS", range(0))
    with pytest.raises(embree_library.NoEmbreeError, match="versions 4"):
        embree_library.embree.__wrapped__()


def test_a_device_that_is_not_there_is_refused_with_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    check_device("cpu")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(UserError, match="linden\\[gpu\\]"):
        check_device("cuda")
