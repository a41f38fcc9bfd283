"""A face with holes as convex polygons of few corners. Corners are whole numbers, so every test is exact.

GEOS cuts a face into Delaunay's triangles between its own corners. They are merged over their longest common sides
(Hertel and Mehlhorn 1983).
"""

from shapely import Polygon, constrained_delaunay_triangles, get_coordinates

from linden.maps.navigation.contour import Corner, Loop

MOST_CORNERS = 6
"""DT_VERTS_PER_POLYGON of Detour."""


def convex_polygons(outer: Loop, holes: list[Loop]) -> list[Loop]:
    """Return polygons that cover a face. All are wound as ``outer`` is: negative area with x right and y down."""
    corners = get_coordinates(constrained_delaunay_triangles(Polygon(outer, holes))).reshape(-1, 4, 2)[:, :3]
    triangles = [[(x, y) for x, y in triangle] for triangle in corners.astype(int).tolist()]
    return _merged([loop if _turn(*loop) < 0 else loop[::-1] for loop in triangles])


def _turn(a: Corner, b: Corner, c: Corner) -> int:
    """Return twice the area of a triangle: negative where it is wound as faces are."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _merged(triangles: list[Loop]) -> list[Loop]:
    """Return convex polygons made of triangles, the longest common sides going first."""
    polygons: dict[int, Loop] = dict(enumerate(triangles))
    owner = {side: number for number, loop in polygons.items() for side in zip(loop, [*loop[1:], loop[0]], strict=True)}
    common = [(a, b) for (a, b) in owner if a < b and (b, a) in owner]
    common.sort(key=lambda side: (-((side[0][0] - side[1][0]) ** 2) - (side[0][1] - side[1][1]) ** 2, side))
    for a, b in common:
        first, second = owner[a, b], owner[b, a]
        if first == second:
            continue
        joined = _joined(polygons[first], polygons[second], a, b)
        if joined is None:
            continue
        for side in zip(polygons[second], [*polygons[second][1:], polygons[second][0]], strict=True):
            owner[side] = first
        polygons[first] = joined
        del polygons[second]
    return list(polygons.values())


def _joined(first: Loop, second: Loop, a: Corner, b: Corner) -> Loop | None:
    """Return two polygons as one over the side a, b of the first, or None where that is not convex, or too large."""
    if len(first) + len(second) - 2 > MOST_CORNERS:
        return None
    i, j = first.index(b), second.index(a)
    ring = [*first[i:], *first[:i], *(second[j:] + second[:j])[1:-1]]
    count = len(ring)
    convex = all(_turn(ring[n - 1], ring[n], ring[(n + 1) % count]) < 0 for n in range(count))
    return ring if convex and len(set(ring)) == count else None
