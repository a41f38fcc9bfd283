"""Small towns to build maps of: streets are given in metres, as one would sketch them."""

import json
import math
from collections.abc import Callable
from importlib import resources
from typing import Any

import pytest

from linden_maps.streets.build import Built, assembled
from linden_maps.streets.geojson import read
from linden_maps.streets.street_facts import Facts
from tracing import untraced_here

ORIGIN = (-83.0, 40.0)
Town = dict[str, Any]


def lonlat(x_m: float, y_m: float) -> list[float]:
    return [ORIGIN[0] + x_m / (111_412.0 * math.cos(math.radians(ORIGIN[1])) * 0.99967), ORIGIN[1] + y_m / 111_035.0]


def street(identity: str, *points: tuple[float, float], **changes: object) -> Town:
    properties = {
        "feature": "street",
        "id": identity,
        "name": f"{identity} Street",
        "street_class": "local",
        "lanes": 2,
        "width_m": 7.9,
        "speed_limit_mph": 25,
        "oneway": "no",
        "parking": "both",
        "sidewalk": "both",
        "confidence": "estimated",
    }
    line = {"type": "LineString", "coordinates": [lonlat(*point) for point in points]}
    return {"type": "Feature", "geometry": line, "properties": properties | changes}


def point(kind: str, identity: str, at: tuple[float, float], **properties: object) -> Town:
    known = {"feature": kind, "id": identity, "name": identity, **properties}
    return {"type": "Feature", "geometry": {"type": "Point", "coordinates": lonlat(*at)}, "properties": known}


def crossing(control: str = "none", **changes: object) -> list[Town]:
    """Two streets that cross in the origin, 100 m to each side."""
    return [
        street("east", (-100.0, 0.0), (0.0, 0.0), (100.0, 0.0)),
        street("north", (0.0, -100.0), (0.0, 0.0), (0.0, 100.0)),
        point("intersection", "middle", (0.0, 0.0), control=control, **changes),
    ]


def collection(features: list[Town], **metadata: object) -> Town:
    known = {"name": "Town", "origin": list(ORIGIN), **metadata}
    return {"type": "FeatureCollection", "metadata": known, "features": features}


@pytest.fixture
def sketch() -> Any:
    """The functions above, for tests that draw a town of their own."""

    class Sketch:
        lonlat = staticmethod(lonlat)
        street = staticmethod(street)
        point = staticmethod(point)
        crossing = staticmethod(crossing)
        collection = staticmethod(collection)

    return Sketch


@pytest.fixture
def facts_of() -> Callable[[list[Town]], Facts]:
    return lambda features: read(collection(features))


@pytest.fixture
def built_of() -> Callable[[list[Town]], Built]:
    return lambda features: assembled(read(collection(features)))


@pytest.fixture(scope="session")
def linden_streets() -> Town:
    text = resources.files("linden").joinpath("data/linden.geojson").read_text(encoding="utf-8")
    found: Town = json.loads(text)
    return found


@pytest.fixture(scope="session")
def linden_built(linden_streets: Town) -> Built:
    with untraced_here():  # its variant without lights takes the same lines
        return assembled(read(linden_streets))
