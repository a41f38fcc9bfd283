"""The risk of each agent of a run for a million miles: as text, as ``risk.json`` and as ``risk.html``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.files import read_json, write_bytes
from basu.output.report.documents import RESULT_FILE, write_json
from basu.output.report.html.page import page
from basu.output.report.templates import render
from basu.records.partners import Partner
from basu.scenarios.nhtsa import TABLE_1_1
from basu.scenarios.risk.estimate import DRAWS, KINDS, PlayedCase, Risk, risk
from basu.scenarios.risk.exposure import CONFLICTS, REPORTED, Exposure
from basu.scenarios.share_documents import results_from

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

PAGE_FILE, RISK_FILE = "risk.html", "risk.json"
LEAST = 0.001  # for a million miles: a smaller figure is shown as below this
ASSUMPTIONS = (
    "A case is a conflict in which a driver has to react, and the cases stand for all conflicts of their group.",
    f"{CONFLICTS} conflicts stand behind {REPORTED} crashes that the police know of (100-Car study), in each group.",
    "Table 1.1 holds for light vehicles on all roads of the United States; a shuttle's streets are others.",
    "A crash is any contact. Human drivers have 69 contacts in 830 conflicts by the same study, 8.3 %.",
    "Injuries are those of the first person hit, or of one occupant; the curves are in `basu.scenarios.risk.injuries`.",
    "A fall is that of one standing passenger without a hold; losing balance is not yet an injury.",
    f"Intervals have 95 % of {DRAWS:,} draws of probabilities, conflicts, curves and unknown cases.",
    "The cases were chosen by hand, and no interval covers that.",
)


def risks_of(folder: Path, matrix: Mapping[str, Any], counted: Exposure) -> dict[str, Risk]:
    """Return the risk of each agent, by its name.

    Raises:
        UserError: the result of a case cannot be read.
    """
    return {agent: risk(_played(folder, matrix, agent), counted) for agent in matrix["agents"]}


def _played(folder: Path, matrix: Mapping[str, Any], agent: str) -> list[PlayedCase]:
    """Return the cases of one agent that left a result."""
    found = []
    for case in matrix["cases"]:
        cell = case["results"].get(agent)
        if cell is None or not cell["folder"]:
            continue
        (counted,) = results_from([{**case, **cell}])
        result = read_json(folder / cell["folder"] / RESULT_FILE, "the document", "play the case again")
        largest = ((result["passengers"] or {}).get("largest") or {}).get("braking_mps2")
        found.append(
            PlayedCase(
                counted=counted,
                completed=cell["assessment"] is not None and cell["assessment"]["completed"]["holds"] is not False,
                partner=Partner(case["characteristics"]["partner"]),
                impact_mps=max((hit["speed_mps"] for hit in cell["collisions"]), default=None),
                braking_mps2=largest or 0.0,
            )
        )
    return found


def risk_text(found: Mapping[str, Risk]) -> list[str]:
    """Return the risks as lines for a console."""
    lines = ["for a million miles, with 95 % intervals"]
    for kind in KINDS:
        lines.append(f"  {kind}")
        lines += [f"    {agent:<16}{_figures(each, kind)}" for agent, each in found.items()]
    for agent, each in found.items():
        reported = sum(group.reported for group in each.groups)
        lines.append(
            f"  {agent}: {len(each.groups)} of {len(TABLE_1_1)} groups played, in which human drivers have "
            f"{reported:.2f} reported crashes for a million miles (table 1.1)"
        )
        if each.unmeasured:
            lines.append(f"    without {', '.join(group.value for group in each.unmeasured)}: their risk is not in it")
        if each.left_out:
            lines.append(f"    {each.left_out} cases left out: a fault of others ended them")
    return lines


def _figures(each: Risk, kind: str) -> str:
    """Return a rate with its interval."""
    rate = each.rates[kind]
    return f"{figure(rate.value)} ({figure(rate.low)} to {figure(rate.high)})"


def figure(value: float) -> str:
    """Return a number with three digits."""
    if value < LEAST:
        return f"below {LEAST:g}" if value > 0.0 else "0"
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def write_risks(folder: Path, found: Mapping[str, Risk]) -> None:
    """Write ``risk.json`` and ``risk.html`` into the folder of a run.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    write_json(folder / RISK_FILE, {agent: _document(each) for agent, each in found.items()})
    body = render(
        "templates/risk.j2",
        risks=found,
        kinds=KINDS,
        figures={agent: {kind: _figures(each, kind) for kind in KINDS} for agent, each in found.items()},
        figure=figure,
        assumptions=ASSUMPTIONS,
    )
    write_bytes(folder / PAGE_FILE, page("Risk for a million miles", body))


def _document(each: Risk) -> dict[str, Any]:
    """Return a risk as plain values."""
    return {
        "rates": {kind: {"value": rate.value, "low": rate.low, "high": rate.high} for kind, rate in each.rates.items()},
        "groups": [{**group._asdict(), "group": group.group.value, "ends": dict(group.ends)} for group in each.groups],
        "unmeasured": [group.value for group in each.unmeasured],
        "left_out": each.left_out,
    }
