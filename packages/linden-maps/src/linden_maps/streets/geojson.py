"""Street facts read from GeoJSON: each feature is checked once, and each refusal names the feature.

``docs/reference/maps.md`` describes the schema. Points are projected (transverse Mercator about the origin) into
OpenDRIVE's frame, x east and y north. They are rounded to 1 mm, so that results do not depend on the projection's last
bits.
"""

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import Any

from pyproj import Proj

from linden.errors import UserError
from linden.maps.opendrive.limits import WIDEST_EXTENT_M
from linden_maps.streets.cross_section import CYCLE_LANE_M
from linden_maps.streets.curves import Point
from linden_maps.streets.street_facts import (
    CYCLE_LANES,
    FURNITURE,
    MOST_LEVELS,
    NARROWEST_M,
    WIDEST_M,
    Building,
    Control,
    Crossing,
    CrossingPlace,
    Facts,
    Furniture,
    Ground,
    Intersection,
    Railroad,
    Route,
    Speed,
    Stop,
    Street,
)

_ROUTES = frozenset({"route", "route_alternative"})
_LINES = _ROUTES | {"street", "railroad"}
_GEOMETRY = {**dict.fromkeys(_LINES, "LineString"), "building": "Polygon"}
_SPEEDS = {"speed_limit_mph": "mph", "speed_limit_kmh": "km/h"}
_CHOICES = {
    "street_class": ("arterial", "collector", "local", "service"),
    "oneway": ("no", "forward"),
    "parking": ("both", "limited", "none/limited", "none"),
    "sidewalk": ("both", "one", "none"),
    "kind": FURNITURE,
    "cycle_lanes": CYCLE_LANES,
}


def read(document: object) -> Facts:
    """Return the facts of a parsed GeoJSON document.

    Raises:
        UserError: what is missing or wrong, and in which feature.
    """
    if not isinstance(document, dict) or document.get("type") != "FeatureCollection":
        raise UserError(
            "this is not a GeoJSON FeatureCollection; docs/reference/maps.md describes the file that is wanted"
        )
    features = [_Feature(number, raw) for number, raw in enumerate(document.get("features", []), start=1)]
    streets = [feature for feature in features if feature.kind == "street"]
    if not streets:
        raise UserError("the file holds no feature of the kind `street`, so there is nothing to build")
    metadata = document.get("metadata", {})
    longitude, latitude = metadata.get("origin", streets[0].lonlats()[0])
    project = Proj(proj="tmerc", lat_0=latitude, lon_0=longitude, k=1, x_0=0, y_0=0, datum="WGS84", units="m")

    def metres(lonlats: Iterable[tuple[float, float]]) -> tuple[Point, ...]:
        return tuple((round(x, 3), round(y, 3)) for x, y in (project(*lonlat) for lonlat in lonlats))

    refuse_too_wide((feature.text("id"), metres(feature.lonlats())) for feature in streets)
    known = {feature.text("id") for feature in streets}
    if len(known) < len(streets):
        raise UserError("two streets share an id; each needs its own")
    names = {feature.text("name") for feature in streets} | known
    plane = metadata.get("ground", {})
    return Facts(
        name=str(metadata.get("name", document.get("name", "map"))),
        longitude_deg=longitude,
        latitude_deg=latitude,
        ground=Ground(
            plane.get("base_m", 0.0),
            plane.get("rise_north", 0.0),
            plane.get("rise_east", 0.0),
            str(plane.get("confidence", "unknown")),
        ),
        turning_circles=bool(metadata.get("turning_circles", False)),
        streets=tuple(_street(feature, metres(feature.lonlats())) for feature in streets),
        intersections=tuple(
            _intersection(feature, metres(feature.lonlats())[0], names)
            for feature in features
            if feature.kind == "intersection"
        ),
        stops=tuple(_stop(f, metres(f.lonlats())[0], known) for f in features if f.kind == "shuttle_stop"),
        schools=tuple(
            CrossingPlace(feature.text("name"), metres(feature.lonlats())[0])
            for feature in features
            if feature.kind == "poi" and feature.properties.get("kind") == "school"
        ),
        routes={f.text("id"): _route(f, metres(f.lonlats())) for f in features if f.kind in _ROUTES},
        crossings=tuple(_crossing(f, metres(f.lonlats())[0], known) for f in features if f.kind == "crossing"),
        buildings=tuple(_building(f, metres(f.lonlats())) for f in features if f.kind == "building"),
        furniture=tuple(_furniture(f, metres(f.lonlats())[0]) for f in features if f.kind == "furniture"),
        railroads=tuple(
            Railroad(metres(f.lonlats()), str(f.properties.get("confidence", "unknown")))
            for f in features
            if f.kind == "railroad"
        ),
        simplify_roundabouts=bool(metadata.get("simplify_roundabouts", False)),
        street_name_signs=str(metadata.get("street_name_signs", "")),
    )


def refuse_too_wide(streets: Iterable[tuple[str, Iterable[Point]]]) -> None:
    """Check that streets, each with its id and its points in m, lie within the extent of a map.

    Raises:
        UserError: two of them lie too far apart; with their ids.
    """
    places = [(point, identity) for identity, points in streets for point in points]
    for axis in (0, 1):
        (low, low_id), (high, high_id) = (
            extreme((point[axis], identity) for point, identity in places) for extreme in (min, max)
        )
        if not high - low <= WIDEST_EXTENT_M:
            far = f"{(high - low) / 1000:,.0f} km" if math.isfinite(high - low) else "thousands of km"
            raise UserError(
                f"the streets {low_id} and {high_id} lie {far} apart; a map has at most {WIDEST_EXTENT_M / 1000:g} km, "
                "so keep the streets of one town"
            )


class _Feature:
    """One GeoJSON feature, asked for its parts; each answer is checked and each refusal names the feature."""

    def __init__(self, number: int, raw: object) -> None:
        if not isinstance(raw, dict) or not isinstance(raw.get("properties"), dict):
            raise UserError(f"feature {number} has no properties; each feature needs at least `feature`, its kind")
        self.properties: dict[str, Any] = raw["properties"]
        self.geometry = raw.get("geometry")
        self.kind = str(self.properties.get("feature"))
        self.label = f"{self.kind} {self.properties.get('id', f'(feature {number})')}"

    def text(self, key: str) -> str:
        return str(self._needed(key))

    def choice(self, key: str) -> str:
        found = self.text(key)
        if found not in _CHOICES[key]:
            raise UserError(f"{self.label}: `{key}` is {found!r}; it can be {', '.join(map(repr, _CHOICES[key]))}")
        return found

    def positive(self, key: str) -> float:
        found = self._needed(key)
        if isinstance(found, bool) or not isinstance(found, (int, float)) or not 0 < found < math.inf:
            raise UserError(f"{self.label}: `{key}` is {found!r}; it must be a number above 0")
        return float(found)

    def speed_limit(self) -> Speed:
        given = {key: unit for key, unit in _SPEEDS.items() if self.properties.get(key) is not None}
        if len(given) > 1:
            raise UserError(f"{self.label}: it has {' and '.join(given)}; keep the one that the signs show")
        key, unit = next(iter(given.items()), ("speed_limit_mph", "mph"))
        return Speed(self.positive(key), unit)

    def level(self) -> int:
        found = self.properties.get("level", 0)
        if not isinstance(found, int) or abs(found) > MOST_LEVELS:
            raise UserError(f"{self.label}: `level` is {found!r}; it is a whole number up to {MOST_LEVELS}")
        return found

    def lonlats(self) -> list[tuple[float, float]]:
        wanted = _GEOMETRY.get(self.kind, "Point")
        geometry = self.geometry if isinstance(self.geometry, dict) else {}
        if geometry.get("type") != wanted:
            raise UserError(f"{self.label}: its geometry is {geometry.get('type')!r}; it must be a {wanted}")
        found = geometry.get("coordinates")
        try:
            points: Any = [found] if wanted == "Point" else found if wanted == "LineString" else found[0]  # type: ignore[index]  # checked by trying
            lonlats = [(float(point[0]), float(point[1])) for point in points]
        except (TypeError, ValueError, IndexError, KeyError):
            raise UserError(f"{self.label}: its coordinates are not pairs of longitude and latitude") from None
        if any(not (abs(lon) <= 180 and abs(lat) <= 90) for lon, lat in lonlats):
            raise UserError(f"{self.label}: its coordinates are not degrees of longitude and latitude")
        if wanted == "LineString" and (len(lonlats) < 2 or any(a == b for a, b in pairwise(lonlats))):
            raise UserError(f"{self.label}: it needs two points at least, and no point twice in a row")
        if wanted == "Polygon" and (len(set(lonlats)) < 3 or lonlats[0] != lonlats[-1]):
            raise UserError(f"{self.label}: its outline needs three corners, and the first one again at the end")
        return lonlats

    def _needed(self, key: str) -> Any:  # noqa: ANN401 - JSON holds anything; the callers narrow it
        if self.properties.get(key) is None:
            raise UserError(f"{self.label}: the property `{key}` is missing")
        return self.properties[key]


def _street(feature: _Feature, points: tuple[Point, ...]) -> Street:
    lanes, width_m = int(feature.positive("lanes")), feature.positive("width_m")
    if width_m > WIDEST_M:
        raise UserError(f"{feature.label}: `width_m` is {width_m:g}; a street has at most {WIDEST_M:g} m between kerbs")
    cycle_lanes = feature.choice("cycle_lanes") if "cycle_lanes" in feature.properties else "none"
    cycle_m = CYCLE_LANE_M * CYCLE_LANES.index(cycle_lanes)
    if width_m - cycle_m < NARROWEST_M * lanes <= width_m:
        raise UserError(
            f"{feature.label}: {lanes} lanes and cycle lanes of {CYCLE_LANE_M} m do not fit between kerbs {width_m} m "
            "apart; widen the street, or leave `cycle_lanes` out"
        )
    if lanes != feature.properties["lanes"] or width_m < NARROWEST_M * lanes:
        raise UserError(
            f"{feature.label}: {feature.properties['lanes']} lanes do not fit between kerbs {width_m} m apart; "
            f"`lanes` is a whole number, and each lane takes {NARROWEST_M} m"
        )
    forward = feature.properties.get("lanes_forward")
    if forward is not None and not (isinstance(forward, int) and 0 < forward <= lanes):
        raise UserError(f"{feature.label}: `lanes_forward` is {forward!r}; it is a whole number from 1 to {lanes}")
    return Street(
        id=feature.text("id"),
        name=feature.text("name"),
        points=points,
        street_class=feature.choice("street_class"),
        lanes=lanes,
        width_m=width_m,
        speed_limit=feature.speed_limit(),
        oneway=feature.choice("oneway") == "forward",
        parking=feature.choice("parking"),
        sidewalk=feature.choice("sidewalk"),
        confidences=tuple(
            (key, str(value)) for key, value in sorted(feature.properties.items()) if key.endswith("confidence")
        ),
        lanes_forward=forward,
        speed_posted=feature.properties.get("speed_posted") is True,
        cycle_lanes=cycle_lanes,
        level=feature.level(),
    )


def _intersection(feature: _Feature, point: Point, streets: set[str]) -> Intersection:
    control = feature.text("control")
    if control not in {member.value for member in Control}:
        known = ", ".join(repr(member.value) for member in Control)
        raise UserError(f"{feature.label}: `control` is {control!r}; it can be {known}")
    stops = frozenset(map(str, feature.properties.get("stop_controlled_streets", [])))
    if not stops <= streets:
        raise UserError(
            f"{feature.label}: `stop_controlled_streets` names {min(stops - streets)!r}, which is no street"
        )
    return Intersection(
        id=feature.text("id"),
        name=feature.text("name"),
        point=point,
        control=Control(control),
        stops=stops,
        confidence=str(feature.properties.get("confidence", "unknown")),
        control_confidence=str(feature.properties.get("control_confidence", "unknown")),
    )


def _stop(feature: _Feature, point: Point, streets: set[str]) -> Stop:
    street_id = feature.text("street_id")
    if street_id not in streets:
        raise UserError(f"{feature.label}: no street has the id {street_id!r}")
    return Stop(
        id=feature.text("id"),
        name=feature.text("name"),
        point=point,
        street_id=street_id,
        forward=bool(feature.properties.get("forward", True)),
        confidence=str(feature.properties.get("confidence", "unknown")),
    )


def _crossing(feature: _Feature, point: Point, streets: set[str]) -> Crossing:
    street_id = feature.text("street_id")
    if street_id not in streets:
        raise UserError(f"{feature.label}: no street has the id {street_id!r}")
    return Crossing(feature.text("id"), point, street_id, str(feature.properties.get("confidence", "unknown")))


def _building(feature: _Feature, ring: tuple[Point, ...]) -> Building:
    return Building(
        id=feature.text("id"),
        name=str(feature.properties.get("name", "")),
        kind=str(feature.properties.get("kind", "yes")),
        ring=ring,
        height_m=feature.positive("height_m"),
        confidence=str(feature.properties.get("height_confidence", "unknown")),
        sign_confidence=str(feature.properties.get("name_sign_confidence", "")),
    )


def _furniture(feature: _Feature, point: Point) -> Furniture:
    return Furniture(
        id=feature.text("id"),
        kind=feature.choice("kind"),
        name=str(feature.properties.get("name", "")),
        point=point,
        confidence=str(feature.properties.get("confidence", "unknown")),
    )


def _route(feature: _Feature, points: tuple[Point, ...]) -> Route:
    return Route(
        id=feature.text("id"),
        points=points,
        closed=bool(feature.properties.get("closed", False)),
        stops=tuple(map(str, feature.properties.get("stops", []))),
        timetable=str(feature.properties.get("timetable", "")),
    )
