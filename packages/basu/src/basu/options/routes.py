"""Options of routes: the file, which routes of it, and their scenarios."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from basu.options.groups import ROUTES
from basu.settings.option import Option, Settings


@dataclass(frozen=True, kw_only=True)
class RouteOptions(Settings):
    """The routes to drive."""

    routes: Annotated[
        str | None,
        Option(help="route XML", group=ROUTES, metavar="FILE", default_text="as the agent says", is_file=True),
    ] = None
    route_id: Annotated[
        str | None,
        Option(help="only this route of the file", group=ROUTES, metavar="ID", default_text="all", rival="route"),
    ] = None
    routes_subset: Annotated[
        str | None,
        Option(help="only these routes of the file, such as 0-3,7", group=ROUTES, metavar="LIST", rival="route"),
    ] = None
    with_scenarios: Annotated[
        bool,
        Option(
            help="leave out the scenarios of the route file",
            group=ROUTES,
            flag="--no-scenarios",
            inverted=True,
            default_text="drive with them",
        ),
    ] = True
    scenario_files: Annotated[
        tuple[Path, ...],
        Option(
            help="classes for the scenarios of the route file; may be given several times",
            group=ROUTES,
            flag="--scenarios",
            metavar="FILE.py",
            is_file=True,
        ),
    ] = ()
