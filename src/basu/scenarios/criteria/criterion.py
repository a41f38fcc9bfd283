"""What a criterion is asked and what it answers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.history import History
    from basu.outcome import Outcome


class Thing(NamedTuple):
    """Something that stood in the scenario and is not among the record's others: its box from above."""

    name: str
    x_m: float
    y_m: float
    yaw_rad: float
    half_length_m: float
    half_width_m: float


class Played(NamedTuple):
    """A case that was driven: all that criteria may see."""

    history: History
    outcome: Outcome  # of the run
    roles: Mapping[int, str]  # of actor ids in the record, for those the scenario brought
    things: tuple[Thing, ...]
    phases_s: Mapping[
        str, float
    ]  # when each phase began, on the clock of the record: trigger, conflict, resolution, end
    timeout_s: float


class Judgement(NamedTuple):
    """What a criterion says, with its evidence."""

    criterion: str  # its name, such as "least distance"
    passed: bool | None  # None: there was nothing to judge by
    deciding: bool  # whether the verdict depends on it
    measured: float | None  # in `unit`; None where there is no figure
    unit: str
    limit: str  # what it was held against, such as "at least 0.5 m"
    sentence: str  # when, where, with whom, how fast
    t_s: float | None = None  # of the moment that decided
    x_m: float | None = None  # of the ego then
    y_m: float | None = None
    other: str | None = None  # the other party: its role, or blueprint id


class Criterion(ABC):
    """One thing to be judged. ``deciding=False`` makes it tell without weighing."""

    name: str

    def __init__(self, *, deciding: bool = True) -> None:
        self.deciding = deciding

    @abstractmethod
    def judge(self, played: Played) -> Judgement:
        """Look through the record."""
