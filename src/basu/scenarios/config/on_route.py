"""The scenarios on the way of a route: ``<scenarios>`` below a ``<route>``, as the leaderboard 2.x has them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from basu.scenarios.config.elements import (
    POINT_ATTRIBUTES,
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
    from collections.abc import Mapping
    from pathlib import Path

    from lxml import etree

    from basu.scenarios.config.model import GivenActor
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
