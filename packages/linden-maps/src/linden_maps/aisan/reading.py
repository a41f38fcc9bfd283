"""An Aisan folder read as Autoware.AI 1.13 reads it, and what its nodes would stumble over.

Rules of vector_map_loader, lane_planner, OpenPlanner and wayarea2grid: the first line is skipped, columns are
positional, a blank or short line ends the loader, ids begin at 1, the lines of an area are chained and consecutive.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from linden.errors import UserError
from linden_maps.aisan.tables import COLUMNS

Folder = dict[str, NDArray[np.float64]]

_INT32 = 2**31
_LETTERS = {"W": 0.0, "Y": 1.0}
_REFERENCES = {
    "node": {"PID": "point"},
    "line": {"BPID": "point", "FPID": "point", "BLID": "line", "FLID": "line"},
    "area": {"SLID": "line", "ELID": "line"},
    "vector": {"PID": "point"},
    "pole": {"VID": "vector"},
    "lane": {
        "DID": "dtlane",
        "BNID": "node",
        "FNID": "node",
        "LinkWAID": "wayarea",
        **{f"{end}LID{nth}": "lane" for end in "BF" for nth in ("", 2, 3, 4)},
    },
    "dtlane": {"PID": "point"},
    "wayarea": {"AID": "area"},
    "whiteline": {"LID": "line", "LinkID": "lane"},
    "stopline": {"LID": "line", "TLID": "signaldata", "SignID": "roadsign", "LinkID": "lane"},
    "roadsign": {"VID": "vector", "PLID": "pole", "LinkID": "lane"},
    "signaldata": {"VID": "vector", "PLID": "pole", "LinkID": "lane"},
    "poledata": {"PLID": "pole", "LinkID": "lane"},
    "intersection": {"AID": "area", "LinkID": "lane"},
    "crosswalk": {"AID": "area", "BdID": "crosswalk", "LinkID": "lane"},
    "roadedge": {"LID": "line", "LinkID": "lane"},
    "curb": {"LID": "line", "LinkID": "lane"},
    "sidewalk": {"AID": "area"},
}
_NEEDED = ("point", "node", "lane", "dtlane")


def read_folder(path: Path) -> Folder:
    """Return the rows of each known file of a folder, columns by position; W is 0 and Y is 1.

    Raises:
        UserError: there is no lane.csv, or a line is one that the loader does not survive; with the file and the line.
    """
    try:
        names = sorted(entry.name for entry in path.iterdir())
    except OSError as error:
        raise UserError(f"cannot read {path}: {error.strerror}; name a folder of .csv files") from None
    missing = [f"{name}.csv" for name in _NEEDED if f"{name}.csv" not in names]
    if missing:
        raise UserError(f"{path} is no Aisan vector map: it has no {', no '.join(missing)}")
    return {name: _rows(path / f"{name}.csv", columns) for name, columns in COLUMNS.items() if f"{name}.csv" in names}


def _rows(path: Path, columns: tuple[str, ...]) -> NDArray[np.float64]:
    try:
        lines = path.read_text(encoding="utf-8").split("\n")[1:]
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"cannot read {path}: {error}") from None
    if lines and not lines[-1]:
        lines.pop()  # what follows the last line's end is no line
    numbers = _plain_numbers(lines, len(columns))
    return _named_rows(path, lines, columns) if numbers is None else numbers


def _plain_numbers(lines: list[str], width: int) -> NDArray[np.float64] | None:
    """Return the rows where each line is one of numbers alone, with an id; else None."""
    if not lines:
        return None
    try:
        rows = np.loadtxt(lines, comments=None, delimiter=",", usecols=range(width), ndmin=2)
    except ValueError:
        return None
    return rows if len(rows) == len(lines) and ((rows[:, 0] > 0) & (rows[:, 0] < _INT32)).all() else None


def _named_rows(path: Path, lines: list[str], columns: tuple[str, ...]) -> NDArray[np.float64]:
    """Return the rows of lines with letters or mistakes; a mistake is named with its line."""
    rows = []
    for number, line in enumerate(lines, start=2):
        cells = line.rstrip("\r").split(",")
        if len(cells) < len(columns):
            what = "is blank" if not line.strip() else f"has {len(cells)} columns; {len(columns)} are needed"
            raise UserError(f"{path}, line {number}: {what}, and Autoware's loader ends there")
        try:
            rows.append([_LETTERS[cell] if cell in _LETTERS else float(cell) for cell in cells[: len(columns)]])
        except ValueError:
            raise UserError(f"{path}, line {number}: a column is no number") from None
        if not 0 < rows[-1][0] < _INT32:
            raise UserError(f"{path}, line {number}: the id {cells[0]} is none from 1 to {_INT32 - 1}")
    return np.array(rows, dtype=np.float64).reshape(-1, len(columns))


def complaints(folder: Folder) -> list[str]:
    """Return what Autoware's nodes would stumble over, a sentence each; the first of each kind, with their number."""
    found = [text for name, rows in folder.items() for text in _id_complaints(folder, name, rows)]
    return found or [*_chain_complaints(folder), *_lane_complaints(folder)]


def _column(folder: Folder, name: str, column: str) -> NDArray[np.int64]:
    return folder[name][:, COLUMNS[name].index(column)].astype(np.int64)


def _id_complaints(folder: Folder, name: str, rows: NDArray[np.float64]) -> list[str]:
    found = []
    ids = rows[:, 0].astype(np.int64)
    if len(np.unique(ids)) != len(ids):
        found.append(f"{name}.csv: ids stand twice; the loader keeps the first row")
    for column, target in _REFERENCES.get(name, {}).items():
        wanted = _column(folder, name, column)
        known = folder[target][:, 0].astype(np.int64) if target in folder else np.empty(0, np.int64)
        wrong = np.flatnonzero((wanted != 0) & ~np.isin(wanted, known))
        if len(wrong):
            found.append(
                f"{name}.csv, line {wrong[0] + 2}: {column} names no row of {target}.csv ({len(wrong)} in all)"
            )
    return found


def _chain_complaints(folder: Folder) -> list[str]:
    """Check the rings of areas: the first line has no predecessor, each goes on in the next, all ids consecutive."""
    if "area" not in folder or "line" not in folder:
        return []
    place = {int(number): row for row, number in enumerate(folder["line"][:, 0])}
    lines: Any = folder["line"].astype(np.int64)
    wrong = []
    for row, (_, first, last) in enumerate(folder["area"].astype(np.int64).tolist()):
        chain = [place.get(number) for number in range(first, last + 1)]
        if not chain or None in chain:
            wrong.append(row)
            continue
        part = lines[chain]
        joined = (part[1:, 1] == part[:-1, 2]).all() and part[0, 1] == part[-1, 2]
        linked = (part[:-1, 4] == part[1:, 0]).all() and (part[1:, 3] == part[:-1, 0]).all()
        if not (joined and linked and part[0, 3] == 0 and part[-1, 4] == 0):
            wrong.append(row)
    text = "its lines are no closed, consecutive chain"
    return [f"area.csv, line {wrong[0] + 2}: {text} ({len(wrong)} in all)"] if wrong else []


def _lane_complaints(folder: Folder) -> list[str]:
    """Check that links agree in both directions, that nodes join, that branches are flagged, and that Dir is right."""
    rows = {name: _column(folder, "lane", name) for name in COLUMNS["lane"] if name != "Span"}
    place = {number: row for row, number in enumerate(rows["LnID"].tolist())}
    after = np.stack([rows[f"FLID{nth}"] for nth in ("", 2, 3, 4)], axis=1)
    before = np.stack([rows[f"BLID{nth}"] for nth in ("", 2, 3, 4)], axis=1)
    pairs = {(a, b) for a, row in zip(rows["LnID"].tolist(), after.tolist(), strict=True) for b in row if b}
    back = {(b, a) for a, row in zip(rows["LnID"].tolist(), before.tolist(), strict=True) for b in row if b}
    found = [f"lane.csv: row {a} leads into {b}, which does not say so" for a, b in sorted(pairs - back)[:1]]
    found += [f"lane.csv: row {b} comes from {a}, which does not say so" for a, b in sorted(back - pairs)[:1]]
    known = [(a, b) for a, b in pairs if a in place and b in place]
    torn = [(a, b) for a, b in sorted(known) if rows["FNID"][place[a]] != rows["BNID"][place[b]]]
    found += [f"lane.csv: row {a} does not end at the node where {b} begins ({len(torn)} in all)" for a, b in torn[:1]]
    flag = rows["JCT"]
    branches, merges = (after != 0).sum(axis=1) > 1, (before != 0).sum(axis=1) > 1
    wrong = (branches & ~np.isin(flag, (1, 2, 5))) | (merges & ~np.isin(flag, (3, 4, 5)))
    wrong |= (flag > 0) & ~(branches | merges)
    for row in np.flatnonzero(wrong)[:1]:
        found.append(f"lane.csv, line {row + 2}: JCT {flag[row]} is wrong ({wrong.sum()} in all)")
    off = heading_errors(folder)
    bad = np.flatnonzero(off > 0.1)
    for row in bad[:1]:
        found.append(f"dtlane.csv: Dir of lane row {row + 1} is off by {off[row]:.2f} rad ({len(bad)} in all)")
    return found


def heading_errors(folder: Folder) -> NDArray[np.float64]:
    """Return how far Dir of each lane row lies from the direction of its two nodes, rad."""
    point = {number: row for row, number in enumerate(folder["point"][:, 0].astype(np.int64).tolist())}
    node = dict(folder["node"].astype(np.int64)[:, :2].tolist())
    detail = {number: row for row, number in enumerate(folder["dtlane"][:, 0].astype(np.int64).tolist())}
    columns = (_column(folder, "lane", name).tolist() for name in ("BNID", "FNID"))
    ends = [folder["point"][[point[node[n]] for n in column]][:, 4:6] for column in columns]
    step = ends[1] - ends[0]
    stated = folder["dtlane"][[detail[n] for n in _column(folder, "lane", "DID").tolist()], 3]
    off = stated - np.arctan2(step[:, 1], step[:, 0])
    wrapped: NDArray[np.float64] = np.abs((off + np.pi) % (2.0 * np.pi) - np.pi)
    return wrapped
