"""``suite-NAME.html``: requirement, test, evidence and confidence of a suite side by side, for each agent."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.files import write_bytes
from basu.output.report.html.page import page
from basu.output.report.scenarios.page.matrix_page import PAGE_FILE
from basu.output.report.scenarios.page.route_section import card_style
from basu.output.report.scenarios.suite_answers import BROKEN, MET, OPEN, answered
from basu.output.report.scenarios.tally import LOOKS
from basu.output.report.templates import render
from basu.scenarios.suites.checks import RequirementAnswer

if TYPE_CHECKING:
    from collections.abc import Mapping

HERE = Path(__file__).parent
STYLES = {MET: "passed", BROKEN: "failed", OPEN: "absent"}
SIGNS = {
    RequirementAnswer.HELD: ("✓", "passed"),
    RequirementAnswer.BROKEN: ("✗", "failed"),
    RequirementAnswer.NOT_DEMANDED: ("=", "unjudged"),
    RequirementAnswer.NOT_SHOWN: ("○", "absent"),
}
MEANINGS = {
    RequirementAnswer.HELD: "held",
    RequirementAnswer.BROKEN: "broken",
    RequirementAnswer.NOT_DEMANDED: "not demanded: what happened is beyond the requirement",
    RequirementAnswer.NOT_SHOWN: "not shown: the conflict did not come about, or the drive was not completed",
}


def suite_page_file(name: str) -> str:
    """Return the name of a suite's page in the folder of a run."""
    return f"suite-{name}.html"


def write_suite_page(folder: Path, document: Mapping[str, Any], matrix: Mapping[str, Any]) -> None:
    """Write the page of a suite into the folder of a run.

    Raises:
        UserError: the disk is full or the folder cannot be written.
    """
    suite = answered(folder, document, matrix)
    body = render(
        "templates/suite.j2",
        suite=suite,
        styles=STYLES,
        signs=SIGNS,
        meanings=[(*SIGNS[answer], text) for answer, text in MEANINGS.items()],
        verdicts={name: look.word for name, look in LOOKS.items()},
        matrix_file=PAGE_FILE,
        facts=f"{matrix['started'][:16].replace('T', ' ')}, seed {matrix['seed']}, "
        f"{matrix['wall_s']:.0f} s on {matrix['workers']} workers, BASU {matrix['versions']['basu']}",
    )
    style = card_style() + (HERE / "suite.css").read_text(encoding="utf-8")
    write_bytes(folder / suite_page_file(document["name"]), page(f"Suite: {document['name']}", body, style=style))
