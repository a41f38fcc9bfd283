"""``basu list``: the agents and routes that come with BASU."""

from __future__ import annotations

import argparse

from basu.agents.loader import names
from basu.files import PACKAGE_FOLDER
from basu.routing.route_file import read_routes


def run(_arguments: argparse.Namespace) -> int:
    """Show the agents and routes that come with BASU."""
    print("agents:")
    for name in names():
        print(f"  {name}")
    print("routes:")
    for path in sorted((PACKAGE_FOLDER / "routes").glob("*.xml")):
        for route in read_routes(path):
            stops = f", {len(route.stops)} service stops" if route.stops else ""
            print(f"  routes/{path.name}: {route.id} in {route.town}, {len(route.points)} points{stops}")
    return 0
