"""Table 5.1 of the thesis, what follows from its formulas, and our table beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from basu.metrics.infraction import Infraction
from basu.metrics.score import driving_score, infraction_score
from basu.metrics.scoring import Scoring
from basu.output.report.templates import e, figure

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from xml.etree.ElementTree import Element


SCORING = Scoring(infraction_weight=0.8)  # the weights below the table
# "running a stop sign was not considered in the driving score for this tests" (section 5.5); no light is on the route
NOT_COUNTED = frozenset({Infraction.STOP_SIGN, Infraction.RED_LIGHT})
ROUNDING = 0.005  # the table has two digits, the driving score three


class Printed(NamedTuple):
    """A row as it is printed."""

    collisions: int
    speeding: int
    infraction: float
    path_following: float
    driving: float

    def infraction_by_formula(self) -> float:
        """Equation 5.1 on the row's counts; the table does not name the other party, the text says "an object"."""
        return infraction_score(
            {Infraction.COLLISION_STATIC: self.collisions, Infraction.SPEEDING: self.speeding}, SCORING
        )

    def driving_by_formula(self) -> float:
        """Equation 5.5 on the printed parts."""
        return driving_score(self.infraction, self.path_following, SCORING)

    def follows(self) -> bool:
        """Whether the printed infraction score is that of the printed counts."""
        return abs(self.infraction_by_formula() - self.infraction) < ROUNDING


class Measured(NamedTuple):
    """The same columns of a run of ours, without the infractions that the thesis did not count."""

    collisions: int
    speeding: int
    infraction: float
    path_following: float
    driving: float
    stop_signs: int  # run; in none of the scores above
    driving_with_stop_signs: float


PRINTED: Mapping[str, Printed] = {
    "basic": Printed(0, 0, 1.0, 0.98, 0.996),
    "behavioral": Printed(1, 1, 0.13, 0.56, 0.216),
    "forward": Printed(1, 1, 0.52, 0.18, 0.452),
    "human": Printed(0, 3, 0.51, 0.98, 0.604),
}


def measured(counts: Mapping[Infraction, int], path_following: float) -> Measured:
    """Our row from a run's infractions and its path following score."""
    counted = {kind: number for kind, number in counts.items() if kind not in NOT_COUNTED}
    infraction = infraction_score(counted, SCORING)
    return Measured(
        collisions=sum(number for kind, number in counts.items() if kind.value.startswith("collision_")),
        speeding=counts.get(Infraction.SPEEDING, 0),
        infraction=infraction,
        path_following=path_following,
        driving=driving_score(infraction, path_following, SCORING),
        stop_signs=counts.get(Infraction.STOP_SIGN, 0),
        driving_with_stop_signs=driving_score(infraction_score(counts, SCORING), path_following, SCORING),
    )


HEADS = (
    "agent",
    "",
    "collisions",
    "speeding",
    "infraction score",
    "path following",
    "driving score",
    "with stop signs",
)
OURS, THEIRS = "here", "thesis"


def lines(printed: Mapping[str, Printed], ours: Mapping[str, Measured]) -> list[tuple[str, ...]]:
    """Two lines an agent: ours, and the thesis's as it is printed there."""
    found: list[tuple[str, ...]] = []
    for agent, row in ours.items():
        with_signs = f"{figure(row.driving_with_stop_signs)} ({row.stop_signs} run)"
        counts = (str(row.collisions), str(row.speeding))
        found.append(
            (agent, OURS, *counts, figure(row.infraction), figure(row.path_following), figure(row.driving), with_signs)
        )
        theirs = printed[agent]
        counts = (str(theirs.collisions), str(theirs.speeding))
        scores = (f"{theirs.infraction:g}", f"{theirs.path_following:g}", f"{theirs.driving:g}")
        found.append(("", THEIRS, *counts, *scores, "not counted"))
    return found


def text(printed: Mapping[str, Printed], ours: Mapping[str, Measured]) -> str:
    """Return the table as text for a console."""
    found = [HEADS, *lines(printed, ours)]
    widths = [max(len(line[column]) for line in found) for column in range(len(HEADS))]
    written = [
        "  ".join(
            cell.ljust(width) if column < 2 else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in found
    ]
    rule = "-" * (sum(widths) + 2 * (len(widths) - 1))
    return "\n".join([written[0], rule, *written[1:]])


def in_page(printed: Mapping[str, Printed], ours: Mapping[str, Measured], explained: Sequence[str]) -> list[Element]:
    """For a page: the table and why it differs."""
    head = e("thead", e("tr", *(e("th", text, scope="col") for text in HEADS)))
    body = e("tbody")
    for line in lines(printed, ours):
        style = "theirs" if line[1] == THEIRS else None
        cells = (e("th", cell, scope="row") if column == 0 else e("td", cell) for column, cell in enumerate(line))
        body.append(e("tr", *cells, class_=style))
    table = e("div", e("table", head, body), class_="wide")
    sentences = e("ul", *(e("li", sentence) for sentence in explained))
    return [e("section", e("h2", "Beside table 5.1 of the thesis"), table, sentences)]
