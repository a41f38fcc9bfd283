"""Results of a campaign's searches: failure boundaries with their uncertainty, and probabilities of rare failures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.campaigns.search_part import SEARCH
from basu.campaigns.search_space import Dimension
from basu.files import read_json
from basu_search.proposal import guards_in, weights_of
from basu_search.rare_event import RareEvent, estimate
from basu_search.rounds import space_filling
from basu_search.search_states import rounds_in, verdict_of
from basu_search.surrogate import Surrogate

if TYPE_CHECKING:
    from pathlib import Path

    import pyarrow as pa
    from numpy.typing import NDArray

    from basu.campaigns.search_space import Space

SURE, MAY = 0.82, 0.18  # probabilities of the failing side between which the boundary lies
# Laplace's approximation is too careful: between 97.5 and 2.5 % lies most of the space. On a circle, a band and a wave
# with 40 to 120 drives these levels hold 95 % of the boundary's length in the mean, at the least 83 %.
SPACE_BITS = 12  # 4,096 points on which shares of the space are computed
COLUMNS = ["number", "identity", "judged", "success", "severity", "fault"]


class Drives(NamedTuple):
    """The drives of one search so far, N of them in D dimensions."""

    about: dict[str, Any]  # the head of the search's file
    space: Space
    points: NDArray[np.float64]  # (N, D) of the unit cube
    failed: NDArray[np.float64]  # (N,) 1 failed, 0 passed, NaN not judged
    broken: NDArray[np.bool_]  # (N,) ended by a fault that is not the agent's
    ids: list[str]  # identities for `basu scenario run`
    numbers: list[int]  # of their jobs
    weights: NDArray[np.float64]  # (N,) of an estimate; 1 in a search
    guards: NDArray[np.float64]  # (N,) probability that no failure was expected there; 0 in a search
    learns: NDArray[np.bool_]  # (N,) whether a drive only moves the proposal

    @property
    def title(self) -> str:
        """Which search it is."""
        weather = "" if self.about["weather"] == "as given" else f", {self.about['weather']}"
        return f"{self.about['subject']} with {self.about['agent']}{weather}, seed {self.about['seed']}"

    @property
    def judged(self) -> NDArray[np.bool_]:
        """(N,) whether a drive says something of the agent."""
        return ~np.isnan(self.failed)


class Share(NamedTuple):
    """A share of the space that fails."""

    value: float
    low: float  # where the surrogate is sure
    high: float  # where it may


class Reach(NamedTuple):
    """What a parameter does."""

    dimension: Dimension
    length: float  # over which the verdict changes along it, as a share of its range: the smaller, the more it decides
    thirds: tuple[Share, Share, Share]  # of the failing share in the thirds of its range


class Boundary(NamedTuple):
    """A search for the boundary."""

    drives: Drives
    surrogate: Surrogate | None  # None where all drives came out alike
    share: Share | None  # of the space
    reach: tuple[Reach, ...]
    nearest: tuple[int, int] | None  # a failure and a success, the nearest to each other

    @property
    def sentences(self) -> list[str]:
        """What is known."""
        judged, failed = int(self.drives.judged.sum()), int(np.nansum(self.drives.failed))
        left = len(self.drives.failed) - judged
        lines = [f"{judged} drives: {failed} failed, {judged - failed} passed."]
        if left:
            lines.append(f"{left} more were not exercised, or ended by a fault that is not the agent's.")
        if self.share is None:
            said = "No drive failed" if not failed else "Every drive failed"
            return [*lines, f"{said}, so there is no boundary between these values."]
        low, high = (f"{100.0 * end:.0f}" for end in (self.share.low, self.share.high))
        lines.append(
            f"Failures take up {100.0 * self.share.value:.0f} % of the space; surely {low} %, at most {high} %."
        )
        assert self.nearest is not None, "there are both verdicts"
        failure, success = self.nearest
        lines.append(f"The nearest failure and success are {self.drives.ids[failure]} and {self.drives.ids[success]}.")
        return lines


class Rare(NamedTuple):
    """An estimate of a probability."""

    drives: Drives
    learned: int  # drives that moved the proposal
    left_out: int  # drives that a fault of simulator, set-up or benchmark ended
    found: RareEvent


def searches_in(folder: Path, table: pa.Table) -> list[Drives]:
    """The searches of a campaign, with the rows that there are.

    Raises:
        UserError: a file of a search cannot be read.
    """
    rows = {row["number"]: row for row in table.select(COLUMNS).to_pylist()}
    found = []
    for path in sorted((folder / SEARCH).glob("*.json"), key=_order):
        document = read_json(path, "the state of a search")
        found.append(_drives(document, rows))
    return [each for each in found if len(each.failed)]


def boundary_in(drives: Drives) -> Boundary:
    """Return the failure boundary of a search, from its judged drives."""
    judged = drives.judged
    points, failed = drives.points[judged], drives.failed[judged] > 0.5
    if not failed.any() or failed.all():
        return Boundary(drives, None, None, (), None)
    surrogate = Surrogate(points, failed)
    at = space_filling(2**SPACE_BITS, len(drives.space), 0)
    side = surrogate.failing(at)
    reach = tuple(
        Reach(each, float(length), tuple(_share(side[third == part]) for part in range(3)))  # type: ignore[arg-type]
        for each, length, third in zip(drives.space, surrogate.lengths(), (at.T * 3.0).astype(np.int64), strict=True)
    )
    return Boundary(drives, surrogate, _share(side), reach, _nearest(drives))


def rare_in(drives: Drives, confidence: float) -> Rare:
    """The probability that an estimate has found: of a drive that fails, among all drives of the distribution.

    A drive that was not exercised did not fail. A drive that a fault of ours ended is left out.
    """
    kept = ~drives.learns & ~drives.broken
    plain = drives.about["settings"]["plain"]
    found = estimate(drives.failed[kept] > 0.5, drives.weights[kept], drives.guards[kept], plain, confidence)
    return Rare(drives, int(drives.learns.sum()), int((~drives.learns & drives.broken).sum()), found)


def _order(path: Path) -> tuple[int, int, str]:
    """The order of searches: by part, strand and agent."""
    part, strand, agent = path.stem.split("-", 2)
    return int(part), int(strand), agent


def _drives(document: dict[str, Any], rows: dict[int, dict[str, Any]]) -> Drives:
    """A search's drives with what came of them."""
    about = {key: value for key, value in document.items() if key != "rounds"}
    space = tuple(Dimension(**each) for each in about["space"])
    is_estimate = about["kind"] == "estimate"
    points: list[NDArray[np.float64]] = [np.empty((0, len(space)))]
    weights: list[NDArray[np.float64]] = [np.empty(0)]
    guards: list[NDArray[np.float64]] = [np.empty(0)]
    found, learns = list[dict[str, Any]](), list[bool]()
    for made, written in zip(rounds_in(document), document["rounds"], strict=True):
        driven = [place for place, number in enumerate(written["numbers"]) if number in rows]
        found += [rows[written["numbers"][place]] for place in driven]
        points.append(made.points[driven])
        weights.append((weights_of(made) if is_estimate else np.ones(len(made.points)))[driven])
        guards.append((guards_in(made) if is_estimate else np.zeros(len(made.points)))[driven])
        learns += [bool(written.get("learns", False))] * len(driven)
    verdicts = [verdict_of(row) for row in found]
    return Drives(
        about,
        space,
        np.concatenate(points),
        np.array([each.failed for each in verdicts], dtype=np.float64),
        np.array([each.broken for each in verdicts], dtype=np.bool_),
        [row["identity"] for row in found],
        [row["number"] for row in found],
        np.concatenate(weights),
        np.concatenate(guards),
        np.array(learns, dtype=np.bool_),
    )


def _share(side: NDArray[np.float64]) -> Share:
    """The failing share of points, by their probabilities of the failing side."""
    return Share(float((side > 0.5).mean()), float((side > SURE).mean()), float((side > MAY).mean()))


def _nearest(drives: Drives) -> tuple[int, int]:
    """The failure and the success that are the nearest to each other."""
    fails, passes = np.flatnonzero(drives.failed == 1.0), np.flatnonzero(drives.failed == 0.0)
    apart = np.linalg.norm(drives.points[fails][:, None, :] - drives.points[passes][None, :, :], axis=2)
    failure, success = np.unravel_index(int(np.argmin(apart)), apart.shape)
    return int(fails[failure]), int(passes[success])
