"""Reads route XML and selects routes of a file: ScenarioRunner's and the leaderboard's format, with ``<stops>``.

Three spellings of a point are in use and all are read: ``<waypoint x y z yaw>`` directly below ``<route>``
(ScenarioRunner, leaderboard 1.0), ``<waypoints><position x y z>`` (leaderboard 2.x), and ``<waypoints><waypoint …>``.
Coordinates are CARLA's: metres, y south, yaw in degrees clockwise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from lxml import etree

from basu.errors import UserError
from basu.routing.timetable import Timetable, read_timetable
from basu.routing.weather import WeatherMark, read_weather

if TYPE_CHECKING:
    from collections.abc import Sequence


OWN_ROUTE = "-own"  # behind the id of a route that is the agent's own


@dataclass(frozen=True, slots=True)
class RoutePoint:
    """A point of the way in CARLA's frame; ``yaw_rad`` is None where the file gives none."""

    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StopMark:
    """A service stop as the file has it."""

    id: str
    name: str
    point: RoutePoint


@dataclass(frozen=True, slots=True, kw_only=True)
class RouteDescription:
    """One ``<route>`` of a file, not yet laid on a map."""

    id: str
    town: str
    points: tuple[RoutePoint, ...]
    stops: tuple[StopMark, ...]
    source: str  # file name, for sentences
    timetable: Timetable | None = None  # from the file that the attribute 'timetable' names, seen from this one
    weather: tuple[WeatherMark, ...] = ()  # as the file gives it along the way; empty where it gives none
    is_own: bool = False  # the agent has planned it or brought its file, so its name is no official route's

    @property
    def official_id(self) -> str:
        """The id that the route file has."""
        return self.id.removesuffix(OWN_ROUTE) if self.is_own else self.id

    def as_own(self) -> RouteDescription:
        """Return the route as the agent's own, under a name that says so."""
        return replace(self, id=f"{self.official_id}{OWN_ROUTE}", is_own=True)


def read_routes(path: Path) -> tuple[RouteDescription, ...]:
    """Read every route of a file, and of the files that it includes (``<include file="…">``, seen from itself).

    Raises:
        UserError: the file is missing, empty, not route XML, holds a point that is not one, or an id twice.
    """
    routes = _read(path, ())
    first: dict[str, str] = {}
    for route in routes:
        if route.id in first:
            raise UserError(
                f"route file {path}: the id '{route.id}' is given twice (in {first[route.id]} and {route.source}); "
                "each route needs its own"
            )
        first[route.id] = route.source
    return routes


def route_element(description: RouteDescription) -> etree._Element:
    """Return the <route> that a description was read from, for readers of its other elements.

    Raises:
        UserError: the file is no longer as it was.
    """
    path = Path(description.source)
    for element in _root(path).iter("route"):
        if element.get("id") == description.id:
            return element
    raise UserError(f"route file {path} has no route '{description.id}' any more; it was changed meanwhile")


def _read(path: Path, including: tuple[Path, ...]) -> tuple[RouteDescription, ...]:
    """Return the routes of one file; ``including`` are the files that led here."""
    root = _root(path)
    chain = (*including, path.resolve())
    included = [
        route for element in root.iterfind("include") for route in _read(_included(path, element, chain), chain)
    ]
    elements = [root] if root.tag == "route" else list(root.iter("route"))
    if not elements and not included:
        raise UserError(f"route file {path} holds no <route> (its outermost element is <{root.tag}>)")
    return (*included, *(_description(element, path) for element in elements))


def _root(path: Path) -> etree._Element:
    """Return the outermost element of a route file."""
    try:
        text = path.read_bytes()
    except OSError as error:
        raise UserError(
            f"route file {path} cannot be read ({error.strerror}); `basu list` shows the routes that come with BASU"
        ) from error
    if not text.strip():
        raise UserError(f"route file {path} is empty; it needs <routes><route id town>… with way points inside")
    try:
        root: etree._Element = etree.fromstring(text, etree.XMLParser(resolve_entities=False, no_network=True))
    except etree.XMLSyntaxError as error:
        raise UserError(f"route file {path} is not XML: {error}") from error
    return root


def _included(path: Path, element: etree._Element, chain: tuple[Path, ...]) -> Path:
    """Return the file that an <include> of ``path`` names; none of the ``chain`` that led to it."""
    name = element.get("file")
    if not name or (path.parent / name).resolve() in chain:
        raise UserError(
            f"route file {path}, line {element.sourceline}: <include> must name another file in its attribute 'file'"
        )
    return path.parent / name


def _description(element: etree._Element, path: Path) -> RouteDescription:
    """Read one ``<route>`` of a route file."""
    identity, town = element.get("id"), element.get("town")
    if identity is None or town is None:
        missing = "id" if identity is None else "town"
        raise UserError(f"route file {path}, line {element.sourceline}: <route> lacks its attribute '{missing}'")
    listed = element.find("waypoints")
    holder = element if listed is None else listed
    points = tuple(_point(e, path) for e in holder if e.tag in {"waypoint", "position"})
    if len(points) < 2:
        raise UserError(
            f"route file {path}, line {element.sourceline}: route '{identity}' has {len(points)} way points "
            "and needs at least 2"
        )
    stops = tuple(
        StopMark(id=e.get("id") or str(number), name=e.get("name") or f"stop {number}", point=_point(e, path))
        for number, e in enumerate(element.iterfind("stops/stop"), start=1)
    )
    timetable = element.get("timetable")
    return RouteDescription(
        id=identity,
        town=town,
        points=points,
        stops=stops,
        source=str(path),
        timetable=None if timetable is None else read_timetable(path.parent / timetable, [stop.id for stop in stops]),
        weather=read_weather(element, path),
    )


def _point(element: etree._Element, path: Path) -> RoutePoint:
    """Return the coordinates of a point; z may be absent, it is found from the road."""
    yaw_deg = _number(element, "yaw", path)
    x_m, y_m = _number(element, "x", path), _number(element, "y", path)
    if x_m is None or y_m is None:
        missing = "x" if x_m is None else "y"
        raise UserError(
            f"route file {path}, line {element.sourceline}: <{element.tag}> lacks its attribute '{missing}'"
        )
    z_m = _number(element, "z", path)
    return RoutePoint(x_m, y_m, 0.0 if z_m is None else z_m, None if yaw_deg is None else math.radians(yaw_deg))


def _number(element: etree._Element, name: str, path: Path) -> float | None:
    """Return an attribute as a finite number, None where it is absent."""
    text = element.get(name)
    if text is None:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise UserError(
            f"route file {path}, line {element.sourceline}: <{element.tag}> has {name}='{text}', which is no number"
        )
    return value


def subset(routes: Sequence[RouteDescription], wanted: str) -> tuple[RouteDescription, ...]:
    """Return the routes that ``wanted`` names, in the order of the file.

    ``wanted`` is a list of ids and of ranges ``first-last``; a range runs from one id to the other in the file's order,
    whatever the ids are. An id with a hyphen in it is taken for what it is.

    Raises:
        UserError: an id that the file does not have, a range backwards, or a route named twice.
    """
    ids = [route.id for route in routes]
    chosen: set[int] = set()
    for part in (text.strip() for text in wanted.split(",")):
        for index in _indices(part, ids, wanted):
            if index in chosen:
                raise UserError(f"--routes-subset {wanted}: route '{ids[index]}' is named twice")
            chosen.add(index)
    return tuple(routes[index] for index in sorted(chosen))


def _indices(part: str, ids: list[str], wanted: str) -> range:
    """Return where the routes of one part of the list stand in the file."""
    if part in ids:
        return range(ids.index(part), ids.index(part) + 1)
    for cut in (position for position, letter in enumerate(part) if letter == "-"):
        first, last = part[:cut].strip(), part[cut + 1 :].strip()
        if first in ids and last in ids:
            if ids.index(first) > ids.index(last):
                raise UserError(
                    f"--routes-subset {wanted}: '{last}' comes before '{first}' in the file; turn them round"
                )
            return range(ids.index(first), ids.index(last) + 1)
    raise UserError(f"--routes-subset {wanted}: the route file has no '{part}'; it has {', '.join(ids)}")
