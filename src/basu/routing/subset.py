"""Which routes of a file are meant: ``--routes-subset 0-3,7``, as the CARLA leaderboard writes it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from basu.routing.route_file import RouteDescription


def subset(routes: Sequence[RouteDescription], wanted: str) -> tuple[RouteDescription, ...]:
    """The routes that ``wanted`` names, in the order of the file.

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
    """Where the routes of one part of the list stand in the file."""
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
