"""``basu list``: the agents and routes that come with BASU."""

from __future__ import annotations

import argparse


def add(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """The command ``list``."""
    listing = commands.add_parser("list", help="show the agents and routes that come with BASU")
    listing.set_defaults(command=list_all)


def list_all(_arguments: argparse.Namespace) -> int:
    """Show the agents and routes that come with BASU."""
    from basu.agents.loader import BUILT_IN  # noqa: PLC0415 - brings in the client
    from basu.routing.route_file import read_routes  # noqa: PLC0415 - likewise
    from basu.utils.packaged import PACKAGE_FOLDER  # noqa: PLC0415 - likewise

    print("agents:")
    for name in BUILT_IN:
        print(f"  {name}")
    print("routes:")
    for path in sorted((PACKAGE_FOLDER / "routes").glob("*.xml")):
        for route in read_routes(path):
            stops = f", {len(route.stops)} service stops" if route.stops else ""
            print(f"  routes/{path.name}: {route.id} in {route.town}, {len(route.points)} points{stops}")
    return 0
