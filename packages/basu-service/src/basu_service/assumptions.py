"""The assumptions of a comparison with and without the shuttle, from a JSON file in which each has its source."""

from __future__ import annotations

from dataclasses import dataclass, fields
from importlib.resources import files
from pathlib import Path

from basu.errors import UserError
from basu.files import read_json

SCHEMA_VERSION = 1
MOST = {"car_share": 1.0, "tail_min": 120.0}


@dataclass(frozen=True, slots=True, kw_only=True)
class Assumptions:
    """The values; the packaged file says where each one comes from."""

    warm_up_min: float  # trips and persons that set out earlier are left out
    tail_min: float  # after the service, for the last ones to arrive
    walk_reach_m: float  # from the beginning of a person's street to the beginning of the stop's
    car_share: float  # of the persons, that drive without the shuttle
    car_access_s: float
    shuttle_kwh_per_km: float
    vehicle_usd_per_h: float
    attendant_usd_per_h: float
    usd_per_kwh: float


def packaged_assumptions() -> Path:
    """Return the file for Linden."""
    return Path(str(files("basu_service") / "data" / "linden_impact.json"))


def read_assumptions(path: Path) -> Assumptions:
    """Read the assumptions of a file.

    Raises:
        UserError: the file is missing, or a value is none; the sentence says which.
    """
    document = read_json(path, "the assumptions", "name a file such as basu_service/data/linden_impact.json")
    if not isinstance(document, dict) or document.get("schema_version") != SCHEMA_VERSION:
        raise UserError(f"the assumptions {path} need schema_version {SCHEMA_VERSION}")
    given = document.get("values")
    names = [field.name for field in fields(Assumptions)]
    if not isinstance(given, dict) or sorted(given) != sorted(names):
        wrong = sorted(set(given if isinstance(given, dict) else {}) ^ set(names))
        raise UserError(f"the assumptions {path} have other values than needed: {', '.join(wrong)}")
    values = {}
    for name in names:
        entry = given[name]
        value = entry.get("value") if isinstance(entry, dict) else None
        most = MOST.get(name, 1e6)
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value <= most:
            raise UserError(f"the assumption {name} of {path} is {value!r}; it must be a number from 0 to {most:g}")
        if not isinstance(entry.get("source"), str) or not entry["source"]:
            raise UserError(f"the assumption {name} of {path} has no source; write where it comes from, or 'ours'")
        values[name] = float(value)
    return Assumptions(**values)
