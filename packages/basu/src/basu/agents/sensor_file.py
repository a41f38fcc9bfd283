"""Reads a sensor set, out of a JSON file or from an agent: the leaderboard's fields, checked against the blueprints.

``{"sensors": [{"type": "sensor.other.gnss", "id": "GPS", "x": 0.7, "y": 0.0, "z": 1.6, …}]}`` or the bare list; beside
``type``, ``id`` and the six of the pose (m and degrees in the vehicle's frame) every field is an attribute of the
sensor's blueprint, or one of the leaderboard's names for some: :data:`LEADERBOARDS_NAMES`. ``data``, of a sensor or
beside ``sensors`` for all, says in which form the agent receives what was measured: ``"numpy"`` or ``"carla"``.
"""

from __future__ import annotations

import difflib
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from basu.errors import UserError
from basu.files import read_json

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    import carla

POSE_FIELDS = ("x", "y", "z", "roll", "pitch", "yaw")
CARLAS_OBJECTS, NUMPY_ARRAYS = "carla", "numpy"
FORMS = (CARLAS_OBJECTS, NUMPY_ARRAYS)
"""What ``data`` may say: the form in which the agent receives measurements."""

LEADERBOARDS_NAMES = {
    ("sensor.camera.", "width"): ("image_size_x",),
    ("sensor.camera.", "height"): ("image_size_y",),
    ("sensor.other.radar", "fov"): ("horizontal_fov", "vertical_fov"),
}
"""By the beginning of a type and a field: the attributes that the CARLA leaderboard sets by it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SensorSpec:
    """One sensor of a set."""

    type_id: str
    id: str
    x_m: float
    y_m: float
    z_m: float
    roll_deg: float
    pitch_deg: float
    yaw_deg: float
    attributes: tuple[tuple[str, str], ...]  # name and value as blueprints have them
    as_numpy: bool = False  # whether the agent receives numpy arrays instead of CARLA's objects


def read_sensors(path: Path) -> tuple[SensorSpec, ...]:
    """Read a sensor set.

    Raises:
        UserError: the file cannot be read, is no JSON, or an entry is incomplete, double or no sensor.
    """
    document = read_json(path, "sensor file")
    entries = document.get("sensors") if isinstance(document, dict) else document
    if not isinstance(entries, list):
        raise UserError(f"sensor file {path} holds no list of sensors")
    form = document.get("data", CARLAS_OBJECTS) if isinstance(document, dict) else CARLAS_OBJECTS
    return parse_sensors(entries, f"sensor file {path}", form)


def parse_sensors(entries: Iterable[Any], source: str, form: object = CARLAS_OBJECTS) -> tuple[SensorSpec, ...]:
    """Read a list of sensors that ``source`` gave, which is what complaints begin with.

    ``form`` is the ``data`` of sensors that name none: one of :data:`FORMS`.

    Raises:
        UserError: an entry is incomplete, double or no sensor.
    """
    specs = tuple(_spec(entry, number, source, form) for number, entry in enumerate(entries, start=1))
    seen: set[str] = set()
    for spec in specs:
        if spec.id in seen:
            raise UserError(f"{source}: the id '{spec.id}' is given twice; each sensor needs its own")
        seen.add(spec.id)
    return specs


def check_sensors(specs: tuple[SensorSpec, ...], library: carla.BlueprintLibrary, source: str) -> None:
    """Hold the set against what the simulator has.

    Raises:
        UserError: a type or an attribute that it does not have.
    """
    known = {blueprint.id: blueprint for blueprint in library.filter("sensor.*")}
    for spec in specs:
        if spec.type_id not in known:
            raise UserError(
                f"{source}: sensor '{spec.id}' has the type '{spec.type_id}', which the simulator does not "
                f"have; {_nearest(spec.type_id, list(known))}"
            )
        names = [attribute.id for attribute in known[spec.type_id]]
        for name, _ in spec.attributes:
            if name not in names:
                raise UserError(
                    f"{source}: sensor '{spec.id}' ({spec.type_id}) has no attribute '{name}'; {_nearest(name, names)}"
                )


def _nearest(wanted: str, known: list[str]) -> str:
    close = difflib.get_close_matches(wanted, known, 1)
    return f"did you mean '{close[0]}'?" if close else f"it has {', '.join(sorted(known))}"


def _spec(entry: Any, number: int, source: str, form: object) -> SensorSpec:  # noqa: ANN401 - as given
    """Return the sensor that one entry of the file describes."""
    if not isinstance(entry, dict) or not isinstance(entry.get("type"), str) or not isinstance(entry.get("id"), str):
        raise UserError(f"{source}: sensor {number} needs a 'type' and an 'id', both texts")
    pose = {}
    for name in POSE_FIELDS:
        value = entry.get(name, 0.0)
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise UserError(f"{source}: sensor '{entry['id']}' has {name} = {value!r}; it must be a number")
        pose[name] = float(value)
    form = entry.get("data", form)
    if form not in FORMS:
        raise UserError(
            f"{source}: sensor '{entry['id']}' has data = {form!r}; it may be 'numpy' for arrays, or 'carla' for "
            "CARLA's objects"
        )
    attributes = {
        attribute: value
        for name, value in entry.items()
        if name not in {"type", "id", "data", *POSE_FIELDS}
        for attribute in _attributes(entry["type"], name)
    }
    return SensorSpec(
        type_id=entry["type"],
        id=entry["id"],
        x_m=pose["x"],
        y_m=pose["y"],
        z_m=pose["z"],
        roll_deg=pose["roll"],
        pitch_deg=pose["pitch"],
        yaw_deg=pose["yaw"],
        attributes=tuple((name, _as_text(value)) for name, value in attributes.items()),
        as_numpy=form == NUMPY_ARRAYS,
    )


def _attributes(type_id: str, name: str) -> tuple[str, ...]:
    """The attributes that a field of a sensor sets: mostly the one that is called so."""
    for (beginning, theirs), ours in LEADERBOARDS_NAMES.items():
        if name == theirs and type_id.startswith(beginning):
            return ours
    return (name,)


def _as_text(value: object) -> str:
    """A JSON value as blueprints spell it."""
    return str(value).lower() if isinstance(value, bool) else str(value)
