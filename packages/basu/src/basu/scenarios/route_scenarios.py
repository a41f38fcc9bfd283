"""The scenarios of a route: ``<scenarios>`` below a ``<route>``, as in the leaderboard 2.x, with class and values.

Beside a route file FILE.xml, FILE.py may hold classes of one's own.
"""

from __future__ import annotations

import difflib
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.routing.route_file import route_element
from basu.scenarios.cases import Library, file_in, plain
from basu.scenarios.class_file import own_scenarios, users_scenarios
from basu.scenarios.stage import EGO
from basu.scenarios.xml_elements import (
    EGO_MODEL,
    POINT_ATTRIBUTES,
    Case,
    GivenActor,
    complaint,
    only,
    other_of,
    parts_of,
    pose_of,
    text_of,
    values_of,
    where,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from lxml import etree

    from basu.routing.route_file import RouteDescription
    from basu.scenarios.playable import Playable
    from basu.scenarios.stage import Pose


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenarioOnRoute:
    """A scenario that waits on a route: a ``Case`` but for town, ego and way, which are the route's."""

    name: str
    type: str
    trigger: Pose
    values: Mapping[str, str] = field(default_factory=dict)  # of its parameters, as text
    others: tuple[GivenActor, ...] = ()
    source: str = ""  # file and line, for sentences


def scenarios_of(route: etree._Element, path: Path) -> tuple[ScenarioOnRoute, ...]:
    """The scenarios of a ``<route>`` in the file's order; none where it has none.

    The leaderboard's own files give some names twice in one route: the second ``Accident_2`` is ``Accident_2-2`` here.

    Raises:
        ScenarioError: one lacks its name, type or trigger point, or has a value that is none.
    """
    named: list[ScenarioOnRoute] = []
    seen: Counter[str] = Counter()
    for element in route.iterfind("scenarios/scenario"):
        found = _scenario(element, path)
        seen[found.name] += 1
        count = seen[found.name]
        named.append(found if count == 1 else replace(found, name=f"{found.name}-{count}"))
    return tuple(named)


def _scenario(element: etree._Element, path: Path) -> ScenarioOnRoute:
    """One ``<scenario>``."""
    only(element, ("name", "type"), path)
    name, kind = text_of(element, "name", path), text_of(element, "type", path)
    parts = parts_of(element)
    triggers = [part for part in parts if part.tag == "trigger_point"]
    if len(triggers) != 1:
        raise complaint(
            element, path, f"'{name}' has {len(triggers)} <trigger_point x y z yaw/> and needs one: where it begins"
        )
    only(triggers[0], POINT_ATTRIBUTES, path)
    return ScenarioOnRoute(
        name=name,
        type=kind,
        trigger=pose_of(triggers[0], path, yaw=True),
        values=values_of([part for part in parts if part.tag not in {"trigger_point", "other_actor"}], path),
        others=tuple(other_of(part, path) for part in parts if part.tag == "other_actor"),
        source=where(element, path),
    )


def scenarios_on(description: RouteDescription, files: Sequence[str | Path] = ()) -> tuple[Playable, ...]:
    """The scenarios of a route in its file's order; ``files`` are a user's with classes.

    Raises:
        ScenarioError: one is not as it should be: its type, a parameter, its trigger point.
    """
    path = Path(description.source)
    waiting = scenarios_of(route_element(description), path)
    if not waiting:
        return ()
    beside = path.with_suffix(".py")
    library = classes_of([*files, *([beside] if beside.is_file() else [])])
    return tuple(_playable(library, each, description) for each in waiting)


def classes_of(files: Sequence[str | Path]) -> Library:
    """BASU's classes and those of a user's files; no cases.

    Raises:
        ScenarioError: a file cannot be used, or a class has the name of another.
    """
    scenarios = list(own_scenarios())
    for file in files:
        path, _ = file_in(str(file))
        if path is None or path.suffix != ".py":
            raise ScenarioError(
                f"--scenarios {file}: name a FILE.py with classes; on a route the route file has the cases"
            )
        taken = {plain(name) for scenario in scenarios for name in (scenario.__name__, *scenario.aliases)}
        for scenario in users_scenarios(path):
            if plain(scenario.__name__) in taken:
                raise ScenarioError(f"{path} has a scenario {scenario.__name__}, and so has BASU; name yours otherwise")
            scenarios.append(scenario)
    return Library(scenarios=tuple(scenarios), cases=(), by_stem={})


def _playable(library: Library, waiting: ScenarioOnRoute, description: RouteDescription) -> Playable:
    """One of them with its class."""
    known = [name for scenario in library.scenarios for name in (scenario.__name__, *scenario.aliases)]
    if waiting.type not in known:
        close = difflib.get_close_matches(waiting.type, known, 1)
        hint = f"did you mean '{close[0]}'? " if close else ""
        types = ", ".join(sorted(scenario.__name__ for scenario in library.scenarios))
        raise ScenarioError(
            f"{waiting.source}: '{waiting.name}' on the way of route '{description.id}' is of type '{waiting.type}', "
            f"which there is not; {hint}there are {types}; `--no-scenarios` drives the route without any"
        )
    case = Case(
        name=waiting.name,
        type=waiting.type,
        town=description.town,
        ego=GivenActor(role=EGO, model=EGO_MODEL, pose=waiting.trigger),
        others=waiting.others,
        trigger=waiting.trigger,
        values=waiting.values,
        place=f"route {description.id}",
        source=waiting.source,
    )
    playable = library.playable(case)
    return playable._replace(case=replace(case, on_route=True))
