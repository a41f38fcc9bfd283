"""The scenarios that wait on the way of a route, with their classes and values: read before anything is started.

Beside a route file FILE.xml, FILE.py may hold classes of one's own.
"""

from __future__ import annotations

import difflib
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.routing.route_file import route_element
from basu.scenarios.cases import Library, file_in, plain
from basu.scenarios.class_file import own_scenarios, users_scenarios
from basu.scenarios.config.elements import EGO_MODEL
from basu.scenarios.config.model import Case, GivenActor
from basu.scenarios.config.on_route import scenarios_of
from basu.scenarios.stage import EGO

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.routing.route_file import RouteDescription
    from basu.scenarios.cases import Playable
    from basu.scenarios.config.on_route import ScenarioOnRoute


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
