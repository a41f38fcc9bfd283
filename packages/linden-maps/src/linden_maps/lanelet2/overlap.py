"""Area that two polygons share, also as a share of the first one."""

from shapely import Polygon, make_valid

from linden.maps.opendrive.evaluate.pieces import F64


def overlap_share(ring: F64, other: F64) -> float:
    """Return the share of a ring's area, (N, 2), that lies inside of another ring, (M, 2)."""
    area = area_m2(ring)
    return overlap_m2(ring, other) / area if area > 0.0 else 0.0


def overlap_m2(ring: F64, other: F64) -> float:
    """Return the area that lies inside of two rings (N, 2) and (M, 2)."""
    return make_valid(Polygon(ring)).intersection(make_valid(Polygon(other))).area


def area_m2(ring: F64) -> float:
    """Return the area of a ring (N, 2)."""
    return Polygon(ring).area
