"""A case as its ``<scenario>`` element has it, and elements of scenario XML as values; errors name file and line."""

from __future__ import annotations

import difflib
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from lxml import etree

from basu.errors import ScenarioError
from basu.routing.weather import WEATHER_FIELDS
from basu.scenarios.stage import EGO, Pose

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from basu.routing.route_file import StopMark


@dataclass(frozen=True, slots=True, kw_only=True)
class GivenActor:
    """An ``<ego_vehicle>`` or ``<other_actor>``."""

    role: str  # `rolename`; "hero" for the ego, "scenario" where another says nothing
    model: str  # a blueprint's id or pattern
    pose: Pose
    attributes: tuple[tuple[str, str], ...] = ()  # such as ("color", "255,0,0")
    speed_mps: float = 0.0
    source: str = ""  # file and line, for sentences


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One instance of a scenario: its actors, place and values."""

    name: str  # its id, unique among all cases of a command
    type: str  # of the scenario
    town: str
    ego: GivenActor
    others: tuple[GivenActor, ...] = ()
    way: tuple[Pose, ...] = ()  # points of the ego's route after its place; the last is where it is bound for
    stops: tuple[StopMark, ...] = ()  # service stops on the way, where the ego is due
    trigger: Pose | None = None  # None: the ego's place
    weather: Mapping[str, float] | None = None  # fields of carla.WeatherParameters that the file gives; None: ClearNoon
    values: Mapping[str, str] = field(default_factory=dict)  # of its parameters, as text
    characteristics: Mapping[str, str] = field(
        default_factory=dict
    )  # stated in the file (`basu.scenarios.characteristics`)
    place: str = ""  # where it is, in words
    on_route: bool = False  # whether on the shuttle's route
    map_file: Path | None = None  # an OpenDRIVE file that the case brings; its name without suffix is the town
    source: str = ""  # file and line, for sentences


EGO_MODEL = "vehicle.easymile.ez10"  # of an <ego_vehicle> without `model`: the shuttle
OTHER_MODEL = "vehicle.*"  # likewise, as in ScenarioRunner
NO_ROLE = "scenario"  # of an <other_actor> without `rolename`, as in ScenarioRunner
EGO_ATTRIBUTES = ("x", "y", "z", "yaw", "model", "rolename")
OTHER_ATTRIBUTES = (*EGO_ATTRIBUTES, "speed", "color")
POINT_ATTRIBUTES = ("x", "y", "z", "yaw")


def where(element: etree._Element, path: Path) -> str:
    """File and line, for sentences."""
    return f"{path}, line {element.sourceline}"


def complaint(element: etree._Element, path: Path, words: str) -> ScenarioError:
    """What is wrong with an element: file, line, tag, and the words."""
    return ScenarioError(f"{where(element, path)}: <{element.tag}> {words}")


def parts_of(element: etree._Element) -> list[etree._Element]:
    """The elements directly inside; comments are none."""
    return [part for part in element if isinstance(part.tag, str)]


def attributes_of(element: etree._Element) -> dict[str, str]:
    """The attributes in the file's order."""
    return {str(name): str(value) for name, value in element.attrib.items()}


def hint(name: str, known: Iterable[str]) -> str:
    """What may have been meant."""
    names = list(known)
    close = difflib.get_close_matches(name, names, 1)
    return f"did you mean '{close[0]}'?" if close else f"it may have {', '.join(names)}"


def only(element: etree._Element, known: Iterable[str], path: Path) -> None:
    """Refuse attributes that would have no effect.

    Raises:
        ScenarioError: there is one.
    """
    names = tuple(known)
    for name in attributes_of(element):
        if name not in names:
            raise complaint(element, path, f"has the attribute '{name}', which is not read here; {hint(name, names)}")


def text_of(element: etree._Element, name: str, path: Path) -> str:
    """An attribute that must be there.

    Raises:
        ScenarioError: it is not, or empty.
    """
    text = (element.get(name) or "").strip()
    if not text:
        raise complaint(element, path, f"lacks its attribute '{name}'; write {name}=\"…\"")
    return text


def number_of(element: etree._Element, name: str, path: Path, unsaid: float | None = None) -> float:
    """An attribute as a finite number; where it is absent, ``unsaid``.

    Raises:
        ScenarioError: it is absent without an ``unsaid``, or no number.
    """
    if unsaid is not None and name not in element.attrib:
        return unsaid
    text = text_of(element, name, path)
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise complaint(element, path, f"has {name}='{text}', which is no number")
    return value


def pose_of(element: etree._Element, path: Path, *, yaw: bool) -> Pose:
    """The place of an element, and its heading where it must give one; z may be absent, it is found from the road."""
    return Pose(
        number_of(element, "x", path),
        number_of(element, "y", path),
        number_of(element, "z", path, 0.0),
        math.radians(number_of(element, "yaw", path, None if yaw else 0.0)),
    )


def ego_of(element: etree._Element, path: Path) -> GivenActor:
    """An ``<ego_vehicle>``.

    Raises:
        ScenarioError: an attribute is missing, no number, or none that has an effect.
    """
    only(element, EGO_ATTRIBUTES, path)
    if element.get("rolename", EGO) != EGO:
        raise complaint(element, path, f"has rolename='{element.get('rolename')}'; the vehicle under test is '{EGO}'")
    return GivenActor(role=EGO, model=element.get("model", EGO_MODEL), pose=pose_of(element, path, yaw=True))


def other_of(element: etree._Element, path: Path) -> GivenActor:
    """An ``<other_actor>``.

    Raises:
        ScenarioError: likewise.
    """
    only(element, OTHER_ATTRIBUTES, path)
    color = element.get("color")
    return GivenActor(
        role=element.get("rolename", NO_ROLE),
        model=element.get("model", OTHER_MODEL),
        pose=pose_of(element, path, yaw=True),
        attributes=() if color is None else (("color", color),),
        speed_mps=number_of(element, "speed", path, 0.0),
        source=where(element, path),
    )


def weather_of(element: etree._Element, path: Path) -> Mapping[str, float]:
    """The fields that a ``<weather>`` gives, in CARLA's units (per cent, degrees, m).

    Raises:
        ScenarioError: weather has no such field, or a value is no number.
    """
    only(element, WEATHER_FIELDS, path)
    return {name: number_of(element, name, path) for name in attributes_of(element)}


def values_of(elements: Iterable[etree._Element], path: Path) -> dict[str, str]:
    """The values of parameters: elements named by the parameter, as in ``<distance value="40"/>``.

    An element with other attributes gives one value each: ``<frequency from="40" to="90"/>`` gives ``frequency_from``
    and ``frequency_to``, ``<start_actor_flow x="1" y="2" z="0"/>`` three.

    Raises:
        ScenarioError: an element has no attribute, or gives a value twice.
    """
    values: dict[str, str] = {}
    for element in elements:
        tag, given = str(element.tag), attributes_of(element)
        if not given:
            raise complaint(element, path, f'gives no value; write <{tag} value="…"/>')
        for name, text in given.items():
            parameter = tag if name == "value" else f"{tag}_{name}"
            if parameter in values:
                raise complaint(element, path, f"gives '{parameter}' a second time; leave one")
            values[parameter] = text.strip()
    return values
