"""The metric of the careful drivers: the key ``careful_drivers`` of ``result.json``, its schema and lines.

There is no verdict of all models together. Both models of the annex of UN Regulation 157 deviate from what drivers did
in 38 real near-crashes (arXiv:2406.09493), so each model answers under its own name.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from basu.metrics.careful_driver.counterfactual import answers, start
from basu.metrics.careful_driver.encounters import encounters
from basu.metrics.careful_driver.eu_cut_in import demand
from basu.metrics.careful_driver.fsm import Fsm
from basu.metrics.careful_driver.human import CarefulHuman
from basu.metrics.careful_driver.model import Situation
from basu.metrics.careful_driver.reg157 import Reg157
from basu.metrics.careful_driver.rss import Rss
from basu.metrics.json_schema import choice, flag, integer, listing, number, record, text
from basu.metrics.registry import NAME_WIDTH, Drive, Metric, register

if TYPE_CHECKING:
    from collections.abc import Mapping

    from basu.metrics.careful_driver.counterfactual import ModelOutcome
    from basu.metrics.careful_driver.encounters import VehicleEncounter
    from basu.metrics.careful_driver.model import CarefulDriver
    from basu.metrics.registry import JudgedRun
    from basu.records.history import History

MODELS: tuple[CarefulDriver, ...] = (Fsm(), CarefulHuman(), Rss(), Reg157())
_ANSWER = record(
    about_="what one model would have done",
    model=choice([model.name for model in MODELS]),
    avoids=flag(about="whether its vehicle touches the other"),
    from_mps=number("m/s", low=0),
    reaction_s=number("s", low=0, null=True),
    hardest_mps2=number("m/s²", low=0),
    impact_mps=number("m/s", low=0),
    least_gap_m=number("m", null=True),
    sentence=text(),
)
_DEMAND = record(
    null_=True,
    about_="the table of (EU) 2022/1426 for cut-ins; null for other situations, and outside of the table",
    ttc_s=number("s", low=0),
    difference_kmh=number("km/h", low=0),
    standing_s=number("s", low=0),
    others_s=number("s", low=0),
    standing=flag(about="whether a vehicle with standing occupants has to avoid it"),
    others=flag(about="whether a vehicle without standing occupants has to avoid it"),
    sentence=text(),
)
_ENCOUNTER = record(
    about_="a contact or a near miss",
    tick=integer(low=0),
    t_s=number("s", low=0),
    x_m=number("m"),
    y_m=number("m"),
    other=text(),
    is_contact=flag(),
    situation=choice([*(each.value for each in Situation), None], "null: none of the three, so there are no answers"),
    begin_s=number("s", low=0, null=True),
    sentence=text(),
    answers=listing(_ANSWER),
    demand=_DEMAND,
)


@register
class CarefulDrivers(Metric):
    """What each of four public models of a careful driver would have done in the encounters of a drive."""

    name = "careful_drivers"
    title = "careful drivers"
    order = 96
    schema = record(
        null_=True,
        about_="what public models of careful drivers would have done: docs/reference/careful-drivers.md",
        encounters=listing(_ENCOUNTER, "contacts with actors, and near misses, in order of time"),
    )

    def compute(self, drive: Drive) -> dict[str, Any]:
        """All encounters with the answers."""
        return {"encounters": [_row(drive.history, each) for each in encounters(drive.history)]}

    def lines(self, result: JudgedRun) -> list[str]:
        """Return a line for each contact with answers, and one for the law."""
        rows = (result.metrics[self.name] or {}).get("encounters", ())
        found = [one for one in rows if one["is_contact"] and one["situation"] is not None]
        lines = [f"{self.title:<{NAME_WIDTH}}{in_words(one)}" for one in found]
        return lines + [
            f"{'law':<{NAME_WIDTH}}{one['demand']['sentence']}" for one in found if one["demand"] is not None
        ]


def in_words(row: Mapping[str, Any]) -> str:
    """Return the answers of all models in a line, each by its name."""
    avoiding = [one["model"] for one in row["answers"] if one["avoids"]]
    hitting = [one["model"] for one in row["answers"] if not one["avoids"]]
    said = [f"avoided by {', '.join(avoiding)}"] if avoiding else []
    said += (
        [f"not by {', '.join(hitting)}" if avoiding else f"avoided by none of {', '.join(hitting)}"] if hitting else []
    )
    return f"at {row['t_s']:.1f} s with {row['other']}, {row['situation']}: {'; '.join(said)}"


def _row(history: History, encounter: VehicleEncounter) -> dict[str, Any]:
    """One encounter as plain values."""
    frame = history.frames[encounter.tick]
    has_begun = encounter.begin_tick >= 0
    demanded = demand(history, encounter, *start(history, encounter)) if has_begun else None
    return {
        "tick": encounter.tick,
        "t_s": float(frame["t_s"]),
        "x_m": float(frame["x_m"]),
        "y_m": float(frame["y_m"]),
        "other": encounter.other,
        "is_contact": encounter.is_contact,
        "situation": None if encounter.situation is None else encounter.situation.value,
        "begin_s": float(history.frames["t_s"][encounter.begin_tick]) if has_begun else None,
        "sentence": encounter.sentence,
        "answers": [_answer(one) for one in answers(history, encounter, MODELS)],
        "demand": None if demanded is None else demanded._asdict(),
    }


def _answer(answer: ModelOutcome) -> dict[str, Any]:
    """One answer as plain values: what was not measured is null."""
    found = answer._asdict()
    for name in ("reaction_s", "least_gap_m"):
        found[name] = found[name] if math.isfinite(found[name]) else None
    return found
