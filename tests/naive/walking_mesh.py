"""A second reader of Detour's tile sets, written from their layout alone, and what stands where on such a mesh."""

import struct
from dataclasses import dataclass, field

import numpy as np

SIDEWALK, CROSSWALK, ROAD = 1, 2, 3


@dataclass
class ReadTile:
    column: int
    row: int
    vertices: np.ndarray  # (V, 3), x, y, z of CARLA's frame
    polygons: list[tuple[int, list[int], list[int], int]]  # area, corners, neighbours as written, flags
    triangles_of: list[list[tuple[int, int, int, int]]] = field(default_factory=list)
    links: int = 0


@dataclass
class ReadMesh:
    origin: tuple[float, float]
    tile_m: float
    most_tiles: int
    most_polygons: int
    tiles: list[ReadTile]
    references: list[int]


def read(data: bytes) -> ReadMesh:
    magic, version, count, ox, _, oz, width, height, most_tiles, most_polygons = struct.unpack_from("<3i5f2i", data)
    assert (magic, version) == (int.from_bytes(b"TESM", "little"), 1)
    assert width == height
    at, tiles, references = 40, [], []
    for _ in range(count):
        reference, size = struct.unpack_from("<Ii", data, at)
        tiles.append(_tile(data[at + 8 : at + 8 + size]))
        references.append(reference)
        at += 8 + size
    assert at == len(data)
    return ReadMesh((ox, oz), width, most_tiles, most_polygons, tiles, references)


def _tile(data: bytes) -> ReadTile:
    head = struct.unpack_from("<5iI9i10f", data)
    assert head[:2] == (int.from_bytes(b"VAND", "little"), 7)
    polygons, vertices, links, details, detail_vertices, detail_triangles, nodes, off_mesh = head[6:14]
    assert (details, detail_vertices, nodes, off_mesh) == (polygons, 0, 0, 0)
    at = 100
    points = np.frombuffer(data, "<f4", 3 * vertices, at).reshape(-1, 3)[:, [0, 2, 1]].astype(float)
    at += 12 * vertices
    found = []
    for n in range(polygons):
        values = struct.unpack_from("<I13H2B", data, at + 32 * n)
        corners = values[14]
        assert values[15] < 64, "an ordinary polygon has type 0 in the two highest bits"
        found.append((values[15], list(values[1 : 1 + corners]), list(values[7 : 7 + corners]), values[13]))
    at += 32 * polygons + 12 * links
    fans = [struct.unpack_from("<IIBBxx", data, at + 12 * n) for n in range(polygons)]
    at += 12 * details
    flat = [struct.unpack_from("<4B", data, at + 4 * n) for n in range(detail_triangles)]
    assert at + 4 * detail_triangles == len(data)
    triangles = [flat[base : base + number] for _, base, _, number in fans]
    return ReadTile(head[2], head[3], points, found, triangles, links)


class Locator:
    """Says which polygons lie over a point of the plane."""

    def __init__(self, mesh: ReadMesh) -> None:
        self._mesh = mesh
        self._tiles: dict[tuple[int, int], list[tuple[int, np.ndarray, np.ndarray, np.ndarray]]] = {}
        for tile in mesh.tiles:
            rings = [(area, tile.vertices[corners]) for area, corners, _, _ in tile.polygons]
            self._tiles[tile.column, tile.row] = [
                (area, ring, ring[:, :2].min(axis=0), ring[:, :2].max(axis=0)) for area, ring in rings
            ]

    def at(self, x: float, y: float, slack_m: float = 0.02) -> list[tuple[int, float]]:
        """Return area and height at its first corner of every polygon in which a point is, or within the slack."""
        (ox, oy), tile_m = self._mesh.origin, self._mesh.tile_m
        found = []
        for column in {int((x - slack_m - ox) // tile_m), int((x + slack_m - ox) // tile_m)}:
            for row in {int((y - slack_m - oy) // tile_m), int((y + slack_m - oy) // tile_m)}:
                for area, ring, low, high in self._tiles.get((column, row), ()):
                    near = (low - slack_m <= (x, y)).all() and (high + slack_m >= (x, y)).all()
                    if near and _distance_inside(ring, x, y) >= -slack_m:
                        found.append((area, float(ring[0, 2])))
        return found


def _distance_inside(ring: np.ndarray, x: float, y: float) -> float:
    """How far inside a convex polygon a point lies, negative outside: the least distance to a side's line."""
    least = np.inf
    for a, b in zip(ring[:, :2], np.roll(ring[:, :2], -1, axis=0), strict=True):
        (dx, dy) = b - a
        least = min(least, -(dx * (y - a[1]) - dy * (x - a[0])) / float(np.hypot(dx, dy)))
    return least
