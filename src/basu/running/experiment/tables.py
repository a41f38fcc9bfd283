"""Our table beside the thesis's: as text for a console, and for the page of the comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.output.report.markup import e, figure

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from xml.etree.ElementTree import Element

    from basu.running.experiment.table_5_1 import Measured, Printed

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
    """For a console."""
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
