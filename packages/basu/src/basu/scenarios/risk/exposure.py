"""How often a vehicle meets a conflict of each group, for a million miles.

*By the table.* Table 1.1 has police-reported crashes for 10^9 vehicle miles. A case of BASU is a conflict in which a
driver has to react, and most such conflicts end without a crash. The 100-Car Naturalistic Driving Study (Dingus and
others 2006, DOT HS 810 593) counted both: 69 crashes and 761 near-crashes, 12 of the crashes reported to the police. So
830 / 12 conflicts stand behind one reported crash. The 12 is quoted from memory. Its chance as a count is part of the
uncertainty; that the ratio differs between groups is not.

*Counted.* A file has events and miles by group, such as those counted in SUMO's traffic by
`scripts/outside/sumo_encounters.py`. A group that stands there is taken from it.
"""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, NamedTuple

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

from basu.errors import ScenarioError
from basu.scenarios.nhtsa import TABLE_1_1, Group

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

CONFLICTS = 69 + 761  # crashes and near-crashes of the 100-Car study
REPORTED = 12  # of its crashes, to the police


class Counted(NamedTuple):
    """Conflicts that were counted on a way."""

    events: int
    miles: float


Exposure = dict[Group, Counted]


def reported_crashes(group: Group) -> float:
    """Return the police-reported crashes of human drivers in a group, for a million miles: table 1.1."""
    return TABLE_1_1[group].per_1e9_miles / 1000.0


def encounters(group: Group, counted: Mapping[Group, Counted]) -> float:
    """Return the conflicts for a million miles."""
    if group in counted:
        return 1e6 * counted[group].events / counted[group].miles
    return reported_crashes(group) * CONFLICTS / REPORTED


def drawn_encounters(
    group: Group, counted: Mapping[Group, Counted], reported: NDArray[np.float64], rng: np.random.Generator
) -> NDArray[np.float64]:
    """Return draws (N,) of the conflicts for a million miles; ``reported`` (N,) are draws of `REPORTED`."""
    if group in counted:
        found = counted[group]
        return 1e6 * rng.gamma(found.events + 0.5, size=len(reported)) / found.miles
    return reported_crashes(group) * CONFLICTS / reported


def read_exposure(path: Path) -> Exposure:
    """Return the counted conflicts of a file: a table for each group, ``[rear-end]`` with ``events`` and ``miles``.

    Raises:
        ScenarioError: it cannot be read, is no TOML, or has another group or value.
    """
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ScenarioError(f"the encounters {path} cannot be read: {error.strerror}; name a TOML file") from error
    except ValueError as error:
        raise ScenarioError(f"the encounters {path} are no TOML: {error}; write a table for each group") from error
    return {_group(name, path): _counted(value, f"{path}: {name}") for name, value in document.items()}


def _group(name: str, path: Path) -> Group:
    """Return a group of the table by its name."""
    known = {group.value: group for group in TABLE_1_1}
    if name not in known:
        raise ScenarioError(f"{path} has encounters of '{name}'; the groups are {', '.join(known)}")
    return known[name]


def _counted(value: object, place: str) -> Counted:
    """Return the values of a table."""
    if isinstance(value, dict) and set(value) == {"events", "miles"}:
        events, miles = value["events"], value["miles"]
        whole = isinstance(events, int) and not isinstance(events, bool) and events >= 0
        if whole and isinstance(miles, int | float) and math.isfinite(miles) and miles > 0.0:
            return Counted(events, float(miles))
    raise ScenarioError(f"{place} is {value!r}; write events = a whole number, and miles = a number above 0")
