"""The registry of metrics: each metric is one class with computation, schema, unit, events and display.

A metric of BASU's own is a class in a module of this package, decorated with `register`; nothing else names it. A
user's metric is a class in a file (``--metrics FILE.py``) or in an installed package (entry point group
``basu.metrics``). All are computed from the record of a run, and from nothing else.
"""

from __future__ import annotations

import functools
import importlib
import inspect
import pkgutil
import re
from abc import abstractmethod
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, TypeVar

from basu.errors import UserError
from basu.files import module_of
from basu.metrics.display import NAME_WIDTH, Column, Display, JudgedRun, TimedMark, is_number, shown
from basu.metrics.json_schema import Schema, number

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from basu.metrics.infraction import Evidence
    from basu.metrics.scoring import Scoring
    from basu.outcome import Outcome
    from basu.records.history import History

__all__ = ["NAME_WIDTH", "Column", "Display", "Drive", "JudgedRun", "Metric", "TimedMark", "Watcher", "shown"]

ENTRY_POINTS = "basu.metrics"
_BUILT_IN: dict[str, Metric] = {}
T = TypeVar("T", bound="type[Metric]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """What a metric is computed from: the record, the rules of scoring, how the run ended, and judged scenarios."""

    history: History
    scoring: Scoring
    outcome: Outcome
    hears_lane_invasions: bool = True  # False in a case: its record has none of these events
    scenarios: tuple[Mapping[str, Any], ...] = ()  # of the route, or the drive's case, as ``result.json`` has them


class Watcher(Protocol):
    """What finds the events of a scored metric while a drive lasts."""

    settled: list[Evidence]  # whatever follows
    pending: list[Evidence]  # found, and not yet settled

    def look(self, window: Callable[[int], History]) -> None:
        """Take in what is new; ``window`` gives the record from a tick on, its ticks counted from there."""


class Metric(Display):
    """One metric. ``name`` is its key in ``result.json``.

    Attributes:
        title: what people call it.
        unit: of the value, where the value is a number.
        digits: after the point, where the value is a number.
        schema: of the value, as JSON Schema.
        nothing: the value where nothing was driven.
        penalties: factors on the infraction score, by kind of event. A metric without one is only reported.
        order: place in tables; equal ones stand by name.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    unit: ClassVar[str] = ""
    digits: ClassVar[int] = 2
    schema: ClassVar[Schema] = number(null=True)
    nothing: ClassVar[Any] = None
    penalties: ClassVar[Mapping[str, float]] = {}
    order: ClassVar[int] = 100

    @abstractmethod
    def compute(self, drive: Drive) -> Any:  # noqa: ANN401 - a value as `schema` says
        """The value, as plain values of JSON."""

    def find(self, drive: Drive) -> tuple[Evidence, ...]:  # noqa: ARG002 - a metric need not have events
        """The events behind the value; those of a scored metric are infractions."""
        return ()

    def watch(self, scoring: Scoring) -> Watcher | None:  # noqa: ARG002 - a metric need not be watched
        """Return what finds the events while a drive lasts; without it they are found at the end of the drive."""
        return None

    def events(self, value: Any) -> Sequence[Mapping[str, Any]]:  # noqa: ANN401 - as above
        """The rows in the value that a report shows with place, time and a sentence."""
        found: Sequence[Mapping[str, Any]] = value.get("events", ()) if isinstance(value, dict) else ()
        return found

    @property
    def heading(self) -> str:
        """What people call it."""
        return self.title

    @property
    def is_scored(self) -> bool:
        """Whether it enters the infraction score."""
        return bool(self.penalties)

    def text(self, result: JudgedRun) -> str | None:
        """Return the value if it is a number."""
        value = result.metrics.get(self.name)
        return self.shown(value) if is_number(value) else None

    def series(self, value: Any) -> Mapping[str, Any]:  # noqa: ANN401, ARG002 - as `schema` says; it need have none
        """Return what a series keeps of the value, by the names of its rows."""
        return {}

    def shown(self, value: float | None) -> str:
        """Return a number with its unit, as people read it."""
        return shown(value, self.unit, self.digits)


def register(metric: T) -> T:
    """Enter a metric of BASU's own; for use as a decorator."""
    assert metric.name not in _BUILT_IN, f"two metrics are called {metric.name}"
    _BUILT_IN[metric.name] = metric()
    return metric


@functools.cache
def built_in() -> tuple[Metric, ...]:
    """BASU's own metrics, in the order of tables. Every module of this package is imported once for that."""
    package = importlib.import_module("basu.metrics")
    for module in pkgutil.walk_packages(package.__path__, "basu.metrics."):
        importlib.import_module(module.name)
    return tuple(sorted(_BUILT_IN.values(), key=lambda metric: (metric.order, metric.name)))


@functools.cache
def installed() -> tuple[EntryPoint, ...]:
    """The metrics of installed packages. Python reads a file of each package for that, which takes 0.1 s."""
    return tuple(entry_points(group=ENTRY_POINTS))


def user_metrics(files: Sequence[Path] = ()) -> tuple[Metric, ...]:
    """The metrics of installed packages and of ``files``, in the order of their names.

    Raises:
        UserError: a file cannot be read or holds no metric, or two metrics have one name.
    """
    found: dict[str, Metric] = {metric.name: metric for metric in built_in()}
    own: list[Metric] = []
    classes = [(f"the entry point {point.name}", point.load()) for point in installed()]
    classes += [(str(path), metric) for path in files for metric in _classes_in(path)]
    for source, metric in classes:
        made = _made(metric, source)
        if made.name in found:
            raise UserError(f"{source}: there is a metric '{made.name}' already; give this one another name")
        found[made.name] = made
        own.append(made)
    return tuple(sorted(own, key=lambda metric: (metric.order, metric.name)))


def _classes_in(path: Path) -> list[type[Metric]]:
    """The metrics that a file defines."""
    if path.suffix != ".py" or not path.is_file():
        raise UserError(f"--metrics: {path} is no Python file; give one that defines a subclass of basu.metrics.Metric")
    module, loader = module_of(path, f"basu_metrics_{path.stem}")
    try:
        loader.exec_module(module)
    except Exception as error:
        raise UserError(f"--metrics: {path} raised {type(error).__name__}: {error}") from error
    found = [
        value
        for value in vars(module).values()
        if inspect.isclass(value) and issubclass(value, Metric) and value.__module__ == module.__name__
    ]
    if not found:
        raise UserError(f"--metrics: {path} defines no subclass of basu.metrics.Metric")
    return found


def _made(metric: object, source: str) -> Metric:
    """An instance of a user's metric.

    Raises:
        UserError: it is no metric, or one of its attributes is missing or wrong.
    """
    if not (inspect.isclass(metric) and issubclass(metric, Metric)):
        raise UserError(f"{source} is no subclass of basu.metrics.Metric")
    for attribute in ("name", "title"):
        if not isinstance(getattr(metric, attribute, None), str):
            raise UserError(f"{source}: {metric.__name__} has no {attribute}; give it one: {attribute} = '...'")
    if not re.fullmatch(r"[a-z][a-z0-9_]*", metric.name):
        raise UserError(f"{source}: '{metric.name}' is no name for a metric; use small letters, digits and _")
    for kind, factor in metric.penalties.items():
        if not 0.0 <= factor <= 1.0:
            raise UserError(f"{source}: the penalty of {kind} is {factor}; it is a factor and must lie in 0..1")
    try:
        return metric()
    except TypeError as error:
        raise UserError(f"{source}: {metric.__name__} cannot be made: {error}") from error
