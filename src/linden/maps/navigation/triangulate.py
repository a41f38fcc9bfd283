"""A face with holes as convex polygons of few corners. Corners are whole numbers, so every test is exact.

Ears are cut off (Meisters 1975), holes first joined to the outside by bridges (Eberly, "Triangulation by ear
clipping"), and triangles then merged over their longest common sides (Hertel and Mehlhorn 1983).
"""

from linden.maps.navigation.contour import Corner, Loop

MOST_CORNERS = 6
"""DT_VERTS_PER_POLYGON of Detour."""


def convex_polygons(outer: Loop, holes: list[Loop]) -> list[Loop]:
    """Return polygons that cover a face. All are wound as ``outer`` is: negative area with x right and y down."""
    loop = outer
    for hole in sorted(holes, key=max, reverse=True):
        loop = _bridged(loop, hole)
    return _merged(_ears(loop))


def _turn(a: Corner, b: Corner, c: Corner) -> int:
    """Return twice the area of a triangle: negative where it is wound as faces are."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _bridged(loop: Loop, hole: Loop) -> Loop:
    """Return the loop with a hole made part of it, over a bridge from the hole's rightmost corner."""
    start = hole.index(max(hole))
    at = hole[start]
    for n in _by_distance(loop, at):
        if _sees(loop, n, at) and not _crossed(loop, hole, loop[n], at):
            return [*loop[: n + 1], *hole[start:], *hole[: start + 1], *loop[n:]]
    return loop  # nothing of the loop can be seen from it: the simplified lines cross, and the hole lies outside


def _by_distance(loop: Loop, at: Corner) -> list[int]:
    def squared(n: int) -> int:
        return (loop[n][0] - at[0]) ** 2 + (loop[n][1] - at[1]) ** 2

    return sorted(range(len(loop)), key=squared)


def _sees(loop: Loop, n: int, at: Corner) -> bool:
    """Whether the way from a corner of the loop to a point begins inside of it."""
    before, corner, after = loop[n - 1], loop[n], loop[(n + 1) % len(loop)]
    if _turn(before, corner, after) < 0:
        return _turn(before, corner, at) < 0 and _turn(corner, after, at) < 0
    return _turn(before, corner, at) < 0 or _turn(corner, after, at) < 0


def _crossed(loop: Loop, hole: Loop, a: Corner, b: Corner) -> bool:
    """Whether a side of the loop or of the hole touches the way from a to b, but at these."""
    for line in (loop, hole):
        for n in range(len(line)):
            p, q = line[n - 1], line[n]
            if p in (a, b) or q in (a, b):
                other = q if p in (a, b) else p
                if other not in (a, b) and _on(a, b, other):
                    return True
                continue
            if _turn(a, b, p) * _turn(a, b, q) <= 0 and _turn(p, q, a) * _turn(p, q, b) <= 0 and _near(a, b, p, q):
                return True
    return False


def _on(a: Corner, b: Corner, p: Corner) -> bool:
    """Whether a point lies on the way from a to b."""
    return _turn(a, b, p) == 0 and _near(a, b, p, p)


def _near(a: Corner, b: Corner, p: Corner, q: Corner) -> bool:
    """Whether the upright rectangles round two lines touch."""
    return all(
        min(a[axis], b[axis]) <= max(p[axis], q[axis]) and min(p[axis], q[axis]) <= max(a[axis], b[axis])
        for axis in (0, 1)
    )


def _ears(loop: Loop) -> list[Loop]:
    """Return the triangles of a simple loop, which may touch itself."""
    left = list(loop)
    triangles: list[Loop] = []
    at, tried = 0, 0
    while len(left) > 3 and tried < len(left):
        at %= len(left)
        before, corner, after = left[at - 1], left[at], left[(at + 1) % len(left)]
        if _turn(before, corner, after) < 0 and _is_empty(left, before, corner, after):
            triangles.append([before, corner, after])
            del left[at]
            tried = 0
            at += 1  # from ear to ear round the face, which makes fewer slivers than a fan
        else:
            at += 1
            tried += 1
    if len(left) == 3 and _turn(*left) < 0:
        triangles.append(left)
    return triangles


def _is_empty(loop: Loop, a: Corner, b: Corner, c: Corner) -> bool:
    """Whether no other corner of the loop lies in a triangle or on its sides."""
    low_x, high_x = min(a[0], b[0], c[0]), max(a[0], b[0], c[0])
    low_y, high_y = min(a[1], b[1], c[1]), max(a[1], b[1], c[1])
    for p in loop:
        near = low_x <= p[0] <= high_x and low_y <= p[1] <= high_y and p not in (a, b, c)
        if near and _turn(a, b, p) <= 0 and _turn(b, c, p) <= 0 and _turn(c, a, p) <= 0:
            return False
    return True


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
