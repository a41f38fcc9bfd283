"""Places that people and cars go to: schools, transit stations and community houses, out of GeoJSON points."""

import json
from importlib import resources
from pathlib import Path
from typing import NamedTuple

from linden.errors import UserError
from linden.scenery.scene.linden_survey import placed
from linden_maps.sumo.net import Net, NetEdge, along

SCHOOL, TRANSIT, COMMUNITY = "school", "transit", "community"
KINDS = (SCHOOL, TRANSIT, COMMUNITY)
REACH_M = 150.0  # from a place to the street that leads to it


class Place(NamedTuple):
    """A place in CARLA's frame."""

    kind: str
    name: str
    x_m: float
    y_m: float


def places_of(path: Path | None, origin_deg: tuple[float, float]) -> tuple[Place, ...]:
    """Return the points of a GeoJSON file with a ``kind`` in `KINDS`; without a file those of Linden.

    ``origin_deg`` is the latitude and longitude of the map's origin.

    Raises:
        UserError: the file cannot be read.
    """
    try:
        if path is None:
            text = (resources.files("linden") / "data" / "linden.geojson").read_text("utf-8")
        else:
            text = path.read_text("utf-8")
        points = [
            (each["properties"], each["geometry"]["coordinates"][:2])
            for each in json.loads(text)["features"]
            if each["geometry"]["type"] == "Point" and each["properties"].get("kind") in KINDS
        ]
        at_m = placed([[float(value) for value in at] for _, at in points], origin_deg)
    except OSError as error:
        raise UserError(f"cannot read the places of {path}: {error.strerror}; name a GeoJSON file") from None
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise UserError(f"{path} is no GeoJSON with points that have a kind of {', '.join(KINDS)}: {error!r}") from None
    return tuple(
        Place(str(facts["kind"]), str(facts.get("name", "")), float(x_m), float(y_m))
        for (facts, _), (x_m, y_m) in zip(points, at_m.tolist(), strict=True)
    )


def car_streets(net: Net, places: tuple[Place, ...], kind: str) -> list[NetEdge]:
    """Return the street for cars that is nearest to each place of a kind; a place far from any has none."""
    return [street for place in places if place.kind == kind and (street := _nearest(net, place, for_cars=True))]


def pavements(net: Net, places: tuple[Place, ...], kind: str) -> list[NetEdge]:
    """Return the street with a pavement that is nearest to each place of a kind; a place far from any has none."""
    return [street for place in places if place.kind == kind and (street := _nearest(net, place, for_cars=False))]


def _nearest(net: Net, place: Place, *, for_cars: bool) -> NetEdge | None:
    x_m, y_m = place.x_m + net.offset_m[0], -place.y_m + net.offset_m[1]
    found = min(
        (
            (along(lane, x_m, y_m)[0], edge.id)
            for edge in net.edges.values()
            for lane in (edge.car_lanes if for_cars else edge.pavements)[:1]
        ),
        default=(REACH_M, ""),
    )
    return net.edges[found[1]] if found[0] < REACH_M else None
