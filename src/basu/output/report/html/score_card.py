"""The score card: the thesis's driving score and how it came about, other judgements of the same drive beside it."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from basu.output.report.console import written
from basu.output.report.html import figures
from basu.output.report.markup import words
from basu.output.report.plots import marks
from basu.output.report.templates import render

if TYPE_CHECKING:
    from markupsafe import Markup

    from basu.metrics.result import Result

FIGURES = ("comfort_parts", "harm", "largest", "balance", "vibration")  # of the passengers, behind their verdict


def score_card(result: Result) -> Markup:
    """The card of a result: equation 5.5 on the left, equation 5.1 on the right, other judgements below."""
    if result.scores is None:
        return render("html/templates/score_card.j2", scores=None)
    counts = Counter(found.kind.value for found in result.infractions)
    passengers, leaderboard = result.metrics["passengers"], result.metrics["leaderboard"]
    shown = {key: passengers[key] for key in FIGURES if key in passengers} if passengers else {}
    scores, scoring = result.scores, result.scoring
    return render(
        "html/templates/score_card.j2",
        scores=scores,
        is_comparable=result.is_comparable,
        ended=result.outcome.status.value,
        score_parts=[
            ("infractions", scores.infraction, round(scoring["infraction_weight"], 6)),
            ("path following", scores.path_following, round(scoring["path_following_weight"], 6)),
        ],
        penalties=[(kind, marks.symbol(kind), counts[kind], penalty) for kind, penalty in scoring["penalties"].items()],
        leaderboard=leaderboard,
        not_measured=sorted({words(kind) for each in (leaderboard or {}).values() for kind in each["not_measured"]}),
        passengers=passengers,
        passenger_figures=figures.table(figures.rows(shown)),
        own=[(own.title, written(own.value, own.unit, own.digits), bool(own.penalties)) for own in result.own.values()],
    )
