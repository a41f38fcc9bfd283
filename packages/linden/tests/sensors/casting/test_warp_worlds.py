"""Rays of many worlds in one launch, against one caster for each world. Skipped where NVIDIA Warp is not installed."""

import numpy as np
import pytest

from fakes.plain_caster import PlainCaster
from fakes.solids import at, box, floor, instances
from linden.geometry import rotation_matrix
from linden.protocol.values.enums import SemanticTag
from linden.protocol.values.space import Rotation
from linden.sensors.casting.caster import NOTHING, Rays
from linden.sensors.view import table_of

pytest.importorskip("warp", reason="needs the extra gpu")

from linden.sensors.casting.warp_caster import WarpCaster
from linden.sensors.casting.warp_worlds import WorldBodies, WorldsCaster

WORLDS, FAR_M = 4, 60.0
SKY = int(SemanticTag.SKY)


@pytest.mark.parametrize("seed", range(5))
def test_rays_of_many_worlds_meet_what_those_of_one_world_meet(seed: int) -> None:
    dice = np.random.default_rng(seed)
    standing, bodies = floor(), [box((2.0, 1.0, 1.0)), box((0.5, 0.5, 2.0))]
    table = table_of(standing, bodies)
    there = WorldsCaster(WarpCaster(standing, bodies, "cpu"), table.first, table.tag)
    towards = dice.normal(size=(300, 3))
    towards = (towards / np.linalg.norm(towards, axis=1, keepdims=True)).astype(np.float32)
    eyes, worlds = np.zeros((WORLDS, 3, 4), np.float32), []
    for world in range(WORLDS):
        turns = [rotation_matrix(Rotation(*dice.uniform(-180.0, 180.0, 3))) for _ in range(world)]
        places = dice.uniform([-6.0, -6.0, 0.0], 6.0, (world, 3))
        worlds.append(instances(*((k % 2, 100 + k, at(*places[k], turns[k])) for k in range(world))))
        eyes[world, :, :3] = rotation_matrix(Rotation(*dice.uniform(-180.0, 180.0, 3)))
        eyes[world, :, 3] = dice.uniform([-5.0, -5.0, 0.1], 5.0)
    begins = np.cumsum([0, *(len(own.mesh) for own in worlds)]).astype(np.int32)
    given = WorldBodies(begins, np.concatenate([w.mesh for w in worlds]), np.concatenate([w.pose for w in worlds]))
    found = there.cast(given, eyes, towards, FAR_M)
    distance_m, face = found.distance_m.numpy(), found.face.numpy()
    met = 0
    for world, own in enumerate(worlds):
        here = PlainCaster(standing, bodies)
        here.pose(own)
        direction = (towards @ eyes[world, :, :3].T).astype(np.float32)
        hits = here.closest(Rays(np.tile(eyes[world, :, 3], (300, 1)), direction), FAR_M, outer=True)
        first = np.concatenate([table.first[:1], table.first[1 + own.mesh]])
        wanted = np.where(hits.instance == NOTHING, -1, first[hits.instance + 1] + hits.triangle)
        assert np.array_equal(face[world], wanted)
        np.testing.assert_allclose(distance_m[world], hits.distance_m, rtol=1e-4, atol=1e-4)
        met += int((hits.instance >= 0).sum())
    assert met > 0


def test_depth_tags_and_points_of_hits() -> None:
    standing, bodies = floor(), [box((1.0, 1.0, 1.0))]
    table = table_of(standing, bodies)
    there = WorldsCaster(WarpCaster(standing, bodies, "cpu"), table.first, table.tag)
    towards = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], np.float32)
    eyes = np.tile(np.eye(3, 4, dtype=np.float32), (2, 1, 1))
    eyes[:, 2, 3] = 1.0
    ahead = instances((0, 7, at(5.0, 0.0, 1.0)))
    hits = there.cast(WorldBodies(np.array([0, 1, 1], np.int32), ahead.mesh, ahead.pose), eyes, towards, FAR_M)
    pixel = np.array([1, 0], np.int32)
    depth_m = there.depth_m(hits, towards, pixel, 2).numpy()
    assert depth_m[:, 1] == pytest.approx([4.0, 1000.0], abs=1e-3)
    tags = there.semantic(hits, pixel, 2).numpy()
    assert tags.tolist() == [[SKY, 3], [SKY, SKY]]
    points, returned = there.points(hits, towards, 0.1)
    assert returned.numpy().tolist() == [[True, False], [False, False]]
    assert points.numpy()[0, 0] == pytest.approx([4.0, 0.0, 0.0, np.exp(-0.4)], abs=1e-5)
    assert not points.numpy()[1].any()
