"""The matrix for a console: groups as blocks, scenarios as rows, agents as columns; at most 110 characters wide."""

from __future__ import annotations

import itertools
import textwrap
from typing import TYPE_CHECKING, Any, NamedTuple

from basu.output.report.scenarios.shares import shares_text
from basu.output.report.scenarios.sweep.boundary import boundary
from basu.output.report.scenarios.tally import LOOKS, blocks, counted, judged_share, name_of, tally, tracks
from basu.output.report.tracks import apart, grouped, titled

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from basu.output.report.scenarios.tally import Tally


WIDTH = 110
NAME_WIDTH, AGENT_WIDTH = 30, 24  # of a scenario and an agent; a longer name is cut
GAP = "   "
LATER = {"FAILURE": 1, "NOT_EXERCISED": 2}
MOST_TOLD = 6  # cases of an agent with a sentence on their end
GREEN, RED, YELLOW, BOLD, DIM, PLAIN = "\x1b[32m", "\x1b[31m", "\x1b[33m", "\x1b[1m", "\x1b[2m", "\x1b[0m"


class TextCell(NamedTuple):
    """What one agent made of a row, as text: the parts are set below each other."""

    share: str  # 2/3
    distance: str  # 0.82 m
    time: str  # 1.4 s
    marks: str  # 1! 3○ 2?
    colour: str


def matrix_text(matrix: dict[str, Any], *, colour: bool = False) -> str:
    """The matrix as lines of text; ``colour`` for a terminal that shows it, and nothing is said by colour alone."""
    parts = [f"{_headline(matrix)}\n{textwrap.fill(judged_share(matrix), WIDTH)}"]
    known = tracks(matrix)
    groups = grouped(matrix["agents"], known)
    parts.append(textwrap.fill(apart(matrix["agents"], known), WIDTH))
    for track, agents in groups.items():
        heading = f"{titled(track)}\n" if track or len(groups) > 1 else ""
        first, *rest = [_table(matrix, beside, colour=colour) for beside in _side_by_side(matrix, agents)]
        parts += [f"{heading}{first}", *rest]
    parts += [_key(matrix), _endings(matrix, colour=colour)]
    parts.append("\n".join(textwrap.fill(sentence, WIDTH, subsequent_indent="  ") for sentence in boundary(matrix)))
    parts.append(shares_text(matrix))
    return "\n\n".join(part for part in parts if part)


def _headline(matrix: dict[str, Any]) -> str:
    """Return what was driven, how often and how long it took."""
    drives = sum(len(case["results"]) for case in matrix["cases"])
    minutes, seconds = divmod(round(matrix["wall_s"]), 60)
    lasted = f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
    agents, cases = ", ".join(matrix["agents"]), counted(len(matrix["cases"]), "case")
    text = f"{matrix['what']} with {agents}: {cases}, {counted(drives, 'drive')} in {lasted}"
    return textwrap.fill(text, WIDTH)


def _side_by_side(matrix: dict[str, Any], agents: Sequence[str]) -> list[list[str]]:
    """Agents of one track, as many together as one table has room for."""
    widths = {agent: sum(_widths(column)) + 3 for agent, column in _columns(matrix, agents).items()}
    tables: list[list[str]] = []
    left = 0
    for agent in agents:
        needed = max(widths[agent], min(len(agent), AGENT_WIDTH)) + len(GAP)
        if not tables or needed > left:
            tables.append([])
            left = WIDTH - NAME_WIDTH
        tables[-1].append(agent)
        left -= needed
    return tables


def _columns(matrix: dict[str, Any], agents: Sequence[str]) -> dict[str, list[TextCell]]:
    """The cells of each agent in the order of the table's rows: of every scenario, and of all cases at the end."""
    rows = [row.cases for block in blocks(matrix) for row in block.rows]
    return {agent: [_cell(tally(cases, agent)) for cases in (*rows, matrix["cases"])] for agent in agents}


def _cell(found: Tally) -> TextCell:
    """Return the text of a cell."""
    signs = ((found.agent_faults, "!"), (found.absent, "○"), (found.unjudged, "?"))
    marks = [f"{count}{sign}" for count, sign in signs if count]
    all_passed = found.passed == found.judged
    return TextCell(
        share=f"{found.passed}/{found.judged}" if found.judged else "-",
        distance=found.narrowest,
        time="" if found.ttc_s is None else f"{found.ttc_s:.1f} s",
        marks=" ".join(marks),
        colour=YELLOW if not found.judged else GREEN if all_passed else RED,
    )


def _widths(cells: Iterable[TextCell]) -> tuple[int, int, int, int]:
    """Return how wide each part of a column is."""
    share, distance, time, marks = (
        max(len(part) for part in parts)
        for parts in zip(*((cell.share, cell.distance, cell.time, cell.marks) for cell in cells), strict=True)
    )
    return share, distance, time, marks


def _table(matrix: dict[str, Any], agents: Sequence[str], *, colour: bool) -> str:
    """One table."""
    columns = _columns(matrix, agents)
    widths = {agent: _widths(cells) for agent, cells in columns.items()}
    spans = {agent: max(sum(widths[agent]) + 3, min(len(agent), AGENT_WIDTH)) for agent in agents}
    heads = GAP.join(f"{_cut(agent, spans[agent]):<{spans[agent]}}" for agent in agents)
    lines = [(f"{'':<{NAME_WIDTH}}{GAP}{heads}").rstrip()]
    number = itertools.count()
    for block in blocks(matrix):
        lines.append(_painted(block.group, BOLD, colour=colour))
        for row in block.rows:
            index = next(number)
            name = f"  {row.scenario}"
            written = [_written(columns[agent][index], widths[agent], spans[agent], colour=colour) for agent in agents]
            lines.append(_line(name, written))
    written = [_written(columns[agent][-1], widths[agent], spans[agent], colour=colour) for agent in agents]
    return "\n".join([*lines, _line("all", written)])


def _line(name: str, cells: Sequence[str]) -> str:
    """Return a row: a name that is too long is cut."""
    return f"{_cut(name, NAME_WIDTH):<{NAME_WIDTH}}{GAP}{GAP.join(cells)}".rstrip()


def _cut(name: str, width: int) -> str:
    return name if len(name) <= width else f"{name[: width - 1]}…"


def _written(cell: TextCell, widths: tuple[int, int, int, int], span: int, *, colour: bool) -> str:
    """Return a cell with its parts at their places."""
    share = _painted(f"{cell.share:>{widths[0]}}", cell.colour, colour=colour)
    rest = f" {cell.distance:>{widths[1]}} {cell.time:>{widths[2]}} {cell.marks:<{widths[3]}}"
    return share + f"{rest:<{max(len(rest), span - widths[0])}}"


def _painted(text: str, colour_code: str, *, colour: bool) -> str:
    """Text in a colour, where there are colours."""
    return f"{colour_code}{text}{PLAIN}" if colour else text


def _key(matrix: dict[str, Any]) -> str:
    """Return what the parts of a cell are, as far as they occur."""
    verdicts = {result["verdict"] for case in matrix["cases"] for result in case["results"].values()}
    notes = ["passed of judged; of those passed, the least distance to any actor, and the least time to a collision."]
    if "AGENT_FAULT" in verdicts:
        notes.append("! the agent itself broke down: judged, and not passed.")
    if "NOT_EXERCISED" in verdicts:
        notes.append("○ not exercised: the conflict never came about; counts for neither side.")
    if any(not LOOKS[verdict].is_judged and verdict != "NOT_EXERCISED" for verdict in verdicts):
        notes.append("? not judged, for a fault of the simulator, the set-up or the benchmark, or interrupted.")
    return "\n".join(notes)


def _endings(matrix: dict[str, Any], *, colour: bool) -> str:
    """How cases ended that were not passed: what needs a look first, then the first few failures of each agent."""
    lines = []
    for agent in matrix["agents"]:
        found = [
            (name_of(case), case["results"][agent])
            for case in matrix["cases"]
            if agent in case["results"] and case["results"][agent]["verdict"] != "SUCCESS"
        ]
        found.sort(key=lambda pair: LATER.get(pair[1]["verdict"], 0))  # faults first; otherwise as they come
        if not found:
            continue
        lines.append(f"{_painted(agent, BOLD, colour=colour)} did not pass {len(found)}:")
        for id_, result in found[:MOST_TOLD]:
            text = f"{LOOKS[result['verdict']].sign} {id_}: {result['message']}"
            lines.append(textwrap.fill(text, WIDTH, initial_indent="  ", subsequent_indent="      "))
        if len(found) > MOST_TOLD:
            lines.append(f"  and {len(found) - MOST_TOLD} more")
    return "\n".join(lines)
