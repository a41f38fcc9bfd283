"""Street attributes from an OpenStreetMap way's tags: class, lanes, width, speed, direction, parking, sidewalks.

What no tag says is guessed from the kind of highway, and each value says which it was: ``tagged``, or ``guessed`` with
the reason. Sources of the meanings: OpenStreetMap Wiki, pages "Key:highway", "Key:lanes", "Key:maxspeed",
"Key:oneway", "Key:width", "Street parking" and "Key:sidewalk".
"""

import re
from typing import NamedTuple

from linden_maps.openstreetmap.extract import Tags
from linden_maps.streets.cross_section import CYCLE_LANE_M, PARKING_M
from linden_maps.streets.street_facts import MOST_LEVELS, NARROWEST_M, WIDEST_M, Speed

CLASS_OF = {
    "motorway": "arterial",
    "trunk": "arterial",
    "primary": "arterial",
    "secondary": "collector",
    "tertiary": "collector",
    "unclassified": "local",
    "residential": "local",
    "living_street": "local",
    "road": "local",
    "service": "service",
}
"""Street class of each kind of highway that cars drive on; a ``_link`` has the class of its kind."""

LANE_M = {"arterial": 3.35, "collector": 3.35, "local": 3.05, "service": 3.05}
"""Guessed lane width: 11 ft and 10 ft, AASHTO's Green Book (2018), urban streets."""

SPEED_MPH = {"arterial": 35.0, "collector": 30.0, "local": 25.0, "service": 15.0}
SPEED_KMH = {"arterial": 50.0, "collector": 50.0, "local": 50.0, "service": 20.0}
"""Guessed limits: the first where the extract's limits are in mph, the second elsewhere."""

TAGGED = "tagged"
MOST_LANES = 12
_FEET_M, _INCH_M = 0.3048, 0.0254
_LENGTH = re.compile(r"^(\d+(?:\.\d+)?)\s*(m|cm|km|ft|')?$")
_FEET = re.compile(r"^(\d+)'\s*(?:(\d+(?:\.\d+)?)\")?$")
_SPEED = re.compile(r"^(\d+(?:\.\d+)?)\s*(mph|km/h|kmh)?$")
_SIDES = ("left", "right")
_PARKED = frozenset({"lane", "street_side", "parallel", "diagonal", "perpendicular", "yes", "on_kerb", "half_on_kerb"})


class Carriageway(NamedTuple):
    """What lies across a way, in the direction of its nodes.

    Parking, sidewalks and cycle lanes (``cycling``) say it for left and right. ``sources``: for each fact, whether it
    is tagged or guessed, and of what.
    """

    name: str
    street_class: str
    forward: int
    backward: int
    width_m: float
    speed: Speed
    parking: tuple[bool, bool]
    sidewalk: tuple[bool, bool]
    cycling: tuple[bool, bool]
    level: int
    sources: tuple[tuple[str, str], ...]


def is_street(tags: Tags) -> bool:
    """Return whether a way is a street that the public may drive on, other than a driveway or a parking aisle."""
    if street_class(tags) is None or tags.get("area") == "yes":
        return False
    if tags.get("service") in {"driveway", "parking_aisle", "drive-through", "emergency_access"}:
        return False
    vehicles = tags.get("motor_vehicle", tags.get("vehicle", tags.get("access", "yes")))
    return vehicles not in {"no", "private", "agricultural", "forestry"}


def street_class(tags: Tags) -> str | None:
    """Return the class of a way's highway, None where no car drives on it."""
    return CLASS_OF.get(tags.get("highway", "").removesuffix("_link"))


def direction(tags: Tags) -> int:
    """Return 1 where traffic follows the order of the nodes alone, -1 where it opposes it, 0 where both are allowed."""
    oneway = tags.get("oneway", "")
    if oneway in {"-1", "reverse"}:
        return -1
    if oneway in {"yes", "true", "1"}:
        return 1
    implied = tags.get("junction") in {"roundabout", "circular"} or tags.get("highway") == "motorway"
    return 1 if implied and oneway not in {"no", "false", "0"} else 0


def carriageway(tags: Tags, *, metric: bool) -> Carriageway:
    """Return what the tags of a street say, and what is guessed. ``metric``: whether guessed limits are in km/h."""
    kind = street_class(tags)
    assert kind is not None, "the way is a street"
    because = f"guessed from highway={tags['highway']}"
    (forward, backward), lanes_source = _lanes(tags, because)
    parking, parking_source = _sides(tags, "parking", _PARKED)
    sidewalk, sidewalk_source = _sides(tags, "sidewalk", frozenset({"yes"}))
    if sidewalk_source != TAGGED:
        separate = tags.get("sidewalk") == "separate" or "separate" in _side_values(tags, "sidewalk")
        walked = separate or kind in {"collector", "local"}
        sidewalk, sidewalk_source = (walked, walked), "guessed from sidewalk=separate" if separate else because
    cycling = cycle_lanes(tags)
    width_m, width_source = _width(tags, forward + backward, kind, sum(parking))
    if width_source.startswith("guessed"):
        width_m = round(width_m + CYCLE_LANE_M * sum(cycling), 2)
    elif width_m - CYCLE_LANE_M * sum(cycling) < NARROWEST_M * (forward + backward):
        cycling = (False, False)
    speed, speed_source = _speed(tags, kind, because, metric=metric)
    name, name_source = _name(tags)
    return Carriageway(
        name,
        kind,
        forward,
        backward,
        width_m,
        speed,
        parking,
        sidewalk,
        cycling,
        level(tags),
        (
            ("lanes_confidence", lanes_source),
            ("name_confidence", name_source),
            ("parking_confidence", parking_source if parking_source == TAGGED else "guessed: no tag, none is built"),
            ("sidewalk_confidence", sidewalk_source),
            ("speed_limit_confidence", speed_source),
            ("width_confidence", width_source),
        ),
    )


def cycle_lanes(tags: Tags) -> tuple[bool, bool]:
    """Return whether a painted cycle lane lies on the left and on the right, each for the traffic of its side.

    Source: OpenStreetMap Wiki, "Key:cycleway". Those on the left of a one-way street, and tracks apart, are no such.
    """
    found = {side: tags.get(f"cycleway:{side}", tags.get("cycleway:both", tags.get("cycleway"))) for side in _SIDES}
    way = direction(tags)
    return found["left"] == "lane" and way <= 0, found["right"] == "lane" and way >= 0


def unbuilt_cycleways(tags: Tags) -> int:
    """Return how many cycle lanes and tracks beside a street its tags have that ``cycle_lanes`` has not."""
    keys = [key for key in ("cycleway", "cycleway:both", "cycleway:left", "cycleway:right") if key in tags]
    tagged = sum(
        (1 if key.endswith(_SIDES) or direction(tags) else 2)
        for key in keys
        if tags[key] in {"lane", "track", "opposite_lane", "opposite_track"}
    )
    return max(tagged - sum(cycle_lanes(tags)), 0)


def level(tags: Tags) -> int:
    """Return how many levels a bridge lies above the ground, a tunnel below it (negative); 0 for other streets."""
    is_bridge = tags.get("bridge", "no") != "no"
    is_tunnel = tags.get("tunnel", "no") not in {"no", "building_passage"}
    if not is_bridge and not is_tunnel:
        return 0
    try:
        given = int(tags.get("layer", ""))
    except ValueError:
        given = 0
    usual = given if given and (given > 0) == is_bridge else 1 if is_bridge else -1
    return max(-MOST_LEVELS, min(MOST_LEVELS, usual))


def metres(text: str) -> float | None:
    """Return a length in m, such as ``7.5``, ``7.5 m``, ``24 ft`` or ``24'6"``; None where it cannot be read."""
    text = text.strip().lower()
    if (found := _FEET.match(text)) is not None:
        return float(found[1]) * _FEET_M + float(found[2] or 0.0) * _INCH_M
    if (found := _LENGTH.match(text)) is not None:
        return float(found[1]) * {"cm": 0.01, "km": 1000.0, "ft": _FEET_M, "'": _FEET_M}.get(found[2] or "m", 1.0)
    return None


def speed_limit(text: str) -> Speed | None:
    """Return a speed limit in the unit of its tag, such as ``50`` (km/h) or ``25 mph``; None where it is no number."""
    found = _SPEED.match(text.strip().lower())
    if found is None or float(found[1]) <= 0.0:
        return None
    return Speed(float(found[1]), "mph" if found[2] == "mph" else "km/h")


def _lanes(tags: Tags, because: str) -> tuple[tuple[int, int], str]:
    """Return lanes along and against the nodes' order, and their source."""
    total, ahead, back = (_count(tags.get(key)) for key in ("lanes", "lanes:forward", "lanes:backward"))
    way = direction(tags)
    if way:
        count = total or (ahead if way > 0 else back)
        found = count or 1
        return ((found, 0) if way > 0 else (0, found)), TAGGED if count else because
    if ahead and back:
        return (ahead, back), TAGGED
    if total and total > 1:
        known = ahead or (total - back if back else None) or (total + 1) // 2
        known = min(known, total - 1)
        split = "" if ahead or back or total % 2 == 0 else "; guessed which direction has the odd lane"
        return (known, total - known), TAGGED + split
    if total == 1:
        return (1, 1), "guessed: lanes=1 with traffic both ways"
    return (1, 1), because


def _count(text: str | None) -> int | None:
    """Return a number of lanes, None where it is missing or unreadable; of ``1;2`` the first."""
    first = (text or "").split(";")[0].strip()
    return int(first) if first.isdecimal() and 0 < int(first) <= MOST_LANES else None


def _width(tags: Tags, lanes: int, kind: str, parked: int) -> tuple[float, str]:
    because = ""
    for key in ("width:carriageway", "width", "est_width"):
        given_m = metres(tags.get(key, ""))
        if given_m is None:
            continue
        if not NARROWEST_M * lanes <= given_m <= WIDEST_M:
            because = f", {key}={tags[key][:20]} cannot be"
            break
        return round(given_m, 2), TAGGED if key != "est_width" else "estimated by the mapper"
    lane_m = LANE_M[kind]
    return round(lanes * lane_m + parked * PARKING_M, 2), f"guessed: lanes of {lane_m} m{because}"


def _speed(tags: Tags, kind: str, because: str, *, metric: bool) -> tuple[Speed, str]:
    found = speed_limit(tags.get("maxspeed", ""))
    if found is None:
        ahead, back = (speed_limit(tags.get(f"maxspeed:{side}", "")) for side in ("forward", "backward"))
        found = min((one for one in (ahead, back) if one is not None), key=lambda one: one.mps, default=None)
    if found is not None:
        return found, TAGGED
    return (Speed(SPEED_KMH[kind], "km/h") if metric else Speed(SPEED_MPH[kind], "mph")), because


def _name(tags: Tags) -> tuple[str, str]:
    for key in ("name", "ref", "official_name"):
        if tags.get(key):
            return tags[key], TAGGED
    return f"unnamed {tags['highway']}", "guessed: no name"


def _sides(tags: Tags, key: str, yes: frozenset[str]) -> tuple[tuple[bool, bool], str]:
    """Return whether something is on the left and on the right, and whether a tag says so."""
    overall = tags.get(key, "")
    if key == "sidewalk" and overall in {"both", "left", "right", "no", "none", "yes"}:
        return (overall in {"both", "left", "yes"}, overall in {"both", "right", "yes"}), TAGGED
    values = _side_values(tags, key)
    if all(value is None or value == "separate" for value in values):
        return (False, False), "no tag"
    return (values[0] in yes, values[1] in yes), TAGGED


def _side_values(tags: Tags, key: str) -> tuple[str | None, str | None]:
    """Return the values of ``key:left`` and ``key:right``, each else that of ``key:both``; older keys too."""

    def value(side: str) -> str | None:
        for known in (f"{key}:{side}", f"{key}:lane:{side}", f"{key}:both", f"{key}:lane:both"):
            if known in tags:
                return tags[known]
        return None

    return value("left"), value("right")
