"""How the value of a metric is shown: lines of the console, cells of comparisons, figures and marks of a run's page.

`Display` has the usual ways, for BASU's metrics and users' metrics alike. A metric of another look overrides some.
A metric that is to have a card of its own on the page has a template in ``output/report/templates/metrics``.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.metrics.infraction import Evidence
    from basu.records.history import History

NAME_WIDTH = 18  # of the names in the console's table
YES, NO, NOT_JUDGED = "yes", "no", "not judged"  # the words of answers
DASH = "\N{EN DASH}"


class JudgedRun(Protocol):
    """What a metric shows of a result: its own value, and the infractions."""

    @property
    def metrics(self) -> Mapping[str, Any]:
        """The value of each metric by name."""

    @property
    def infractions(self) -> Sequence[Evidence]:
        """What entered the score."""


class Column(NamedTuple):
    """One cell of a table that compares runs."""

    head: str
    text: str


class TimedMark(NamedTuple):
    """A mark or a stretch on the timeline."""

    begin_s: float
    end_s: float | None  # None: a mark
    title: str  # a sentence
    label: str = ""
    style: str = "at"  # class in report.css


class Answer(NamedTuple):
    """The answer to a question about a drive in words, with the reason."""

    question: str
    word: str
    reason: str

    @property
    def sentence(self) -> str:
        """Return the answer with its reason."""
        return f"{self.word}: {self.reason}"


class Display(ABC):
    """What can be shown of a result under one heading.

    Attributes:
        has_figures: whether the page lists all figures of the value in a section of its own.
        timeline_row: the name of its row on the timeline; empty: it has none.
    """

    has_figures: ClassVar[bool] = False
    timeline_row: ClassVar[str] = ""

    @property
    @abstractmethod
    def heading(self) -> str:
        """What people call it."""

    @property
    @abstractmethod
    def is_scored(self) -> bool:
        """Whether it enters the infraction score."""

    @abstractmethod
    def text(self, result: JudgedRun) -> str | None:
        """Return the value in a word or a number; None where that is not possible."""

    def lines(self, result: JudgedRun) -> list[str]:
        """Return the lines of the console's table; nothing that did not happen takes a line."""
        text = self.text(result)
        return [] if text is None else [f"{self.heading:<{NAME_WIDTH}}{text}"]

    def columns(self, result: JudgedRun) -> list[Column]:
        """Return the cells of a table that compares runs."""
        text = self.text(result)
        return [] if text is None else [Column(self.heading, text)]

    def answers(self, result: JudgedRun) -> Sequence[Answer]:  # noqa: ARG002 - it need have none
        """Return answers to questions of people, which stand at the head of a result."""
        return ()

    def moments(self, result: JudgedRun, history: History) -> Sequence[TimedMark]:  # noqa: ARG002 - it need have none
        """Return what its row of the timeline has."""
        return ()

    def remark(self, result: JudgedRun) -> str:  # noqa: ARG002 - it need have none
        """Return words that have to stand beside the driving score; empty where there are none."""
        return ""


def shown(value: float | None, unit: str, digits: int) -> str:
    """Return a number with its unit; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return DASH
    return f"{value:.{digits}f}{f' {unit}' if unit else ''}"


def is_number(value: object) -> bool:
    """Return whether a value is a number and no flag."""
    return isinstance(value, float | int) and not isinstance(value, bool)
