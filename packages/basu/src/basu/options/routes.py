"""Options of routes: the file, which routes of it, and their scenarios."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from basu.settings.option import Settings, option


@dataclass(frozen=True, kw_only=True)
class RouteOptions(Settings):
    """The routes to drive."""

    GROUP = "routes and scenarios"

    routes: str | None = option(None, "route XML", metavar="FILE", default_text="as the agent says", is_file=True)
    route_id: str | None = option(None, "only this route of the file", metavar="ID", default_text="all", rival="route")
    routes_subset: str | None = option(
        None, "only these routes of the file, such as 0-3,7", metavar="LIST", rival="route"
    )
    with_scenarios: bool = option(
        True,
        "leave out the scenarios of the route file",
        flag="--no-scenarios",
        inverted=True,
        default_text="drive with them",
    )
    scenario_files: tuple[Path, ...] = option(
        (),
        "classes for the scenarios of the route file; may be given several times",
        flag="--scenarios",
        metavar="FILE.py",
    )
