"""Claims about the voxel filter, beside the obvious one."""

import tracemalloc
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from linden.errors import UserError
from linden_maps.pointcloud.cloud import Cloud
from linden_maps.pointcloud.voxels import VoxelGrid


def filtered(folder: Path, clouds: Iterable[Cloud], voxel_m: float = 0.2, **limits: int) -> Cloud:
    grid = VoxelGrid(voxel_m, folder, **limits)
    for cloud in clouds:
        grid.add(cloud)
    parts = list(grid.clouds())
    labels = [part.label for part in parts if part.label is not None]
    return Cloud(np.concatenate([part.points_m for part in parts]), np.concatenate(labels))


def obvious(points_m: np.ndarray, voxel_m: float) -> dict[tuple[int, ...], np.ndarray]:
    cells = defaultdict(list)
    for point in points_m:
        cells[tuple(np.floor(point / voxel_m).astype(int).tolist())].append(point)
    return {cell: np.mean(inside, axis=0) for cell, inside in cells.items()}


def scattered(count: int, size_m: float, seed: int = 4) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-size_m, size_m, (count, 3)) * (1.0, 1.0, 0.1)


@pytest.mark.parametrize("voxel_m", [0.05, 0.2, 1.0])
def test_each_cell_has_the_mean_of_its_points(voxel_m: float, tmp_path: Path) -> None:
    points = scattered(4000, 3.0)
    found = filtered(tmp_path, [Cloud(points[:1000]), Cloud(points[1000:])], voxel_m).points_m
    expected = obvious(points, voxel_m)
    assert len(found) == len(expected)
    for point in found:
        np.testing.assert_allclose(point, expected[tuple(np.floor(point / voxel_m).astype(int).tolist())], atol=1e-5)


def test_the_order_of_the_points_does_not_matter(tmp_path: Path) -> None:
    points = scattered(5000, 40.0)
    forwards = filtered(tmp_path, [Cloud(points)])
    backwards = filtered(tmp_path, [Cloud(part[::-1]) for part in np.array_split(points, 7)][::-1])
    np.testing.assert_array_equal(forwards.points_m, backwards.points_m)


def test_what_waits_on_the_disk_counts_like_what_is_in_memory(tmp_path: Path) -> None:
    clouds = [Cloud(scattered(2000, 150.0, seed), np.arange(2000, dtype=np.uint32)) for seed in (1, 2, 1, 3)]
    roomy = filtered(tmp_path, clouds, 0.5)
    tight = filtered(tmp_path, clouds, 0.5, most_places=10_000)
    np.testing.assert_array_equal(roomy.points_m, tight.points_m)
    np.testing.assert_array_equal(roomy.label, tight.label)
    assert list(tmp_path.iterdir()) == []  # taken back in, all of it


@pytest.mark.parametrize("at_once", [1, 200])
@pytest.mark.unmeasured
def test_memory_is_held_within_the_limit_whatever_the_area(at_once: int, tmp_path: Path) -> None:
    fields = [np.abs(scattered(100, 100.0, n)) + np.array([n * 128.0, 0.0, 0.0]) for n in range(200)]  # side by side
    clouds = [Cloud(np.concatenate(fields[first : first + at_once])) for first in range(0, 200, at_once)]
    filtered(tmp_path, clouds[:1], most_places=1)  # what the compiler takes, is taken
    grid = VoxelGrid(0.5, tmp_path, most_places=40_000)
    tracemalloc.start()
    try:
        for cloud in clouds:
            grid.add(cloud)
        _, most = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    of_a_point = 8 + 8 + 12 + 8 + 8 + 8 + 4  # tile, key, steps, order, tile in order, its row, label
    assert most <= 28 * (40_000 + 2 * 4_096) + of_a_point * at_once * 100 + 100_000
    assert grid.bytes_in_memory <= 28 * 40_000
    assert len(list(tmp_path.iterdir())) > 10


def test_memory_does_not_grow_with_scans_of_the_same_place(tmp_path: Path) -> None:
    grid, points = VoxelGrid(0.2, tmp_path), scattered(3000, 10.0)
    grid.add(Cloud(points))
    after_one = grid.bytes_in_memory
    for _ in range(200):
        grid.add(Cloud(points))
    assert grid.bytes_in_memory == after_one


def test_cells_of_a_map_larger_than_32_bits_can_number_stay_apart(tmp_path: Path) -> None:
    # 20 km x 20 km x 1 km of cells of 0.1 m: 4e14 of them; PCL's filter lets such numbers run over
    corners = np.array([[x, y, z] for x in (-1e4, 1e4) for y in (-1e4, 1e4) for z in (0.0, 1e3)]) + 0.05
    found = filtered(tmp_path, [Cloud(corners)], 0.1).points_m
    np.testing.assert_allclose(sorted(found.tolist()), sorted(corners.tolist()), atol=1e-5)


def test_no_mean_leaves_its_cell_however_many_points_fall_into_it(tmp_path: Path) -> None:
    corner = np.nextafter(np.full((100_000, 3), 0.2), 0.0)  # more than count, as far out as can be
    (found,) = filtered(tmp_path, [Cloud(corner)] * 2).points_m
    np.testing.assert_allclose(found, 0.2, atol=1e-5)
    assert (found < 0.2).all()


def test_a_cell_keeps_the_label_that_came_first(tmp_path: Path) -> None:
    clouds = [Cloud(np.full((1, 3), 0.1), np.array([label], np.uint32)) for label in (7, 3, 9)]
    assert filtered(tmp_path, clouds).label.tolist() == [7]


@pytest.mark.parametrize("far", [1e30, -1e30, 3e8])
def test_a_point_without_a_cell_gets_a_sentence(far: float, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"too far away for cells of 0\.2 m"):
        VoxelGrid(0.2, tmp_path).add(Cloud(np.array([[0.0, 0.0, 0.0], [0.0, far, 0.0]])))


def test_a_cloud_without_a_point_is_none(tmp_path: Path) -> None:
    grid = VoxelGrid(0.2, tmp_path)
    grid.add(Cloud(np.empty((0, 3))))
    assert list(grid.clouds()) == []
