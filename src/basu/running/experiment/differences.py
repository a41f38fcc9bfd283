"""What lies between our table and table 5.1, in sentences: from the figures where they say it, else what is known."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.metrics.infraction import Infraction
from basu.metrics.score import driving_score
from basu.running.experiment.table_5_1 import ROUNDING, SCORING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.running.experiment.table_5_1 import Measured, Printed

SMALL = 0.0005  # of a score that is printed with three digits
CLOSE = 0.02  # of path following: 15 m of the short route

# why the paths' lengths are what they are, where they differ
PATHS = {
    "basic": "our driver keeps to the middle of the planned lane; where the thesis's lost 0.02 it does not say",
    "behavioral": "where the car leaves its path on purpose and what it hits was chosen here, as near to the thesis's "
    "0.56 of the route as something hard stands beside it",
    "forward": "how far a car gets that never steers is a matter of what stands straight ahead of its start; the "
    "thesis's points A and B are known from a small picture only (figure 5.2), and so is what stood there",
    "human": "another driver, and other lines through the bends",
}
STOP_SIGNS = (
    "Stop signs are in neither driving score: the thesis left them out, because CARLA's agents do not see them or "
    "never drive on. With them our scores are those of the last column."
)
NOTES = {
    "behavioral": "`deviating` drives here: `behavioral`, which leaves its path on purpose at one place, too fast, and "
    "stays where it hits something",
}


def differences(printed: Mapping[str, Printed], ours: Mapping[str, Measured], keys_by: str) -> list[str]:
    """Sentences for all agents; ``keys_by`` says who pressed the keys of the human's session."""
    found = [STOP_SIGNS]
    for agent, row in ours.items():
        note = f"keys were pressed by: {keys_by}" if agent == "human" else NOTES.get(agent)
        parts = [_score(printed[agent], row), _counts(printed[agent], row), _formula(printed[agent])]
        parts += [_path(agent, printed[agent], row), note]
        found.append(f"{agent}: " + "; ".join(part for part in parts if part) + ".")
    return found


def _score(theirs: Printed, row: Measured) -> str:
    """Both scores."""
    apart = row.driving - theirs.driving
    if abs(apart) < SMALL:
        return f"driving score {row.driving:.3f} as in the thesis"
    return f"driving score {row.driving:.3f}, {apart:+.3f} to the thesis's {theirs.driving:.3f}"


def _counts(theirs: Printed, row: Measured) -> str:
    """What was done wrong, there and here."""
    if (row.collisions, row.speeding) == (theirs.collisions, theirs.speeding):
        return "the same infractions"
    return (
        f"{_number(row.collisions, 'collision')} and {row.speeding} times too fast here, "
        f"{_number(theirs.collisions, 'collision')} and {theirs.speeding} times there"
    )


def _formula(theirs: Printed) -> str | None:
    """Whether the thesis's row follows from its own equations, and what would."""
    exact = theirs.infraction_by_formula()
    if not theirs.follows():
        factors = " x ".join(
            f"{SCORING.penalties[kind]:g}"
            for kind, number in (
                (Infraction.COLLISION_STATIC, theirs.collisions),
                (Infraction.SPEEDING, theirs.speeding),
            )
            for _ in range(number)
        )
        score = driving_score(exact, theirs.path_following, SCORING)
        return (
            f"the printed infraction score of {theirs.infraction:g} does not follow from "
            f"{_number(theirs.collisions, 'collision')} and {_number(theirs.speeding, 'speeding')}: equation 5.1 gives "
            f"{factors} = {exact:.2f}, with which the row's driving score is {score:.3f} (from {theirs.infraction:g} "
            f"the printed {theirs.driving:g} does follow)"
        )
    score = driving_score(exact, theirs.path_following, SCORING)
    if round(score, 3) != theirs.driving:
        return (
            f"the thesis rounds the infraction score {exact:.3f} to {theirs.infraction:g} before it weighs it, "
            f"which turns {score:.4f} into {theirs.driving:g}"
        )
    return None


def _path(agent: str, theirs: Printed, row: Measured) -> str | None:
    """Why the path following is another."""
    if abs(row.path_following - theirs.path_following) < ROUNDING:
        return None
    size = "nearly " if abs(row.path_following - theirs.path_following) <= CLOSE else "not "
    return f"path following {row.path_following:.3f} is {size}the thesis's {theirs.path_following:g}: {PATHS[agent]}"


def _number(count: int, what: str) -> str:
    """A count in words as far as it goes."""
    return f"{ ({0: 'no', 1: 'one'}.get(count, str(count))) } {what}{'' if count == 1 else 's'}"
