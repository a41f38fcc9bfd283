"""Several vehicles under test in one run, as reports show them: the document, lines for the console, and links."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.output.report.documents import read_document

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

SHUTTLES_FILE, SHUTTLES_SCHEMA = "shuttles.json", "shuttles.schema.json"
SHUTTLES_SCHEMA_VERSION = 1


def read_shuttles(folder: Path) -> dict[str, Any] | None:
    """Return the document of a run with several vehicles; None for a run with one.

    Raises:
        UserError: it cannot be read, or is not as its schema says.
    """
    path = folder / SHUTTLES_FILE
    if not path.exists():
        return None
    return read_document(path, SHUTTLES_SCHEMA)


def folder_of(number: int) -> str:
    """Return the name of the folder of a vehicle below the run's; empty for the first, which has the run's own."""
    return "" if number == 1 else f"shuttle_{number}"


def links(shuttle: Mapping[str, Any] | None) -> list[dict[str, str]]:
    """Return the vehicles of a run as its reports link to them, without a link for ``shuttle`` itself.

    ``shuttle`` is what ``config.json`` says of the vehicle; None where it is the only one.
    """
    if shuttle is None:
        return []
    found = []
    for number, agent in enumerate(shuttle["agents"], 1):
        way = [".."] * (shuttle["number"] > 1) + [folder_of(number)] * (number > 1)
        report = "" if number == shuttle["number"] else "/".join([*way, "report.html"])
        found.append({"name": f"shuttle {number} ({agent})", "report": report})
    return found


def shuttle_line(document: Mapping[str, Any], place: int) -> str:
    """Return the line above the table of a vehicle, which stands at ``place`` in the run, counted from 0."""
    shuttle = document["shuttles"][place]
    where = "at the start" if place == 0 else f"{shuttle['start_m']:g} m ahead of the start"
    return f"shuttle {shuttle['number']}         {shuttle['role']}, driven by {shuttle['agent']}, {where}"


def contact_lines(document: Mapping[str, Any]) -> list[str]:
    """Return a line for each contact between vehicles under test, with the judgement for each."""
    if not document["contacts"]:
        return ["contacts          none between the shuttles"]
    lines = []
    for contact in document["contacts"]:
        judged = "; ".join(
            f"shuttle {number}: {sentence or 'its drive was over'}"
            for number, sentence in zip(contact["between"], contact["sentences"], strict=True)
        )
        one, other = contact["between"]
        lines.append(f"contact           shuttles {one} and {other} at {contact['t_s']:.1f} s ({judged})")
    return lines
