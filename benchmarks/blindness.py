"""Which perception each case needs: drivers blind to one kind of partner, and the verdict of each on each case.

``python benchmarks/blindness.py [--driver NAME] [--blind cyclists,props|partner] [--workers N] [--markdown] [WHAT …]``

Without WHAT, the first case of each scenario is played. A case must be passed by its reference driver (column
``sighted``), must not be passed by that driver blind to the case's partner, nor blind to signs where the control device
at the conflict is a stop sign; blindness to anything else must not change the verdict. ``--blind partner`` plays the
first two columns alone. Exit code 1 where a cell is not as it must be.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import sys
import tempfile
from collections import defaultdict
from pathlib import Path
from typing import Any

from basu.cli import main
from basu.records.partners import Partner
from basu.scenarios.cases import open_library
from basu.scenarios.characteristics import Characteristics, TrafficControl, characteristics_of
from basu.scenarios.playable import Playable

SIGHTED = "sighted"
KINDS = [kind for kind in Partner if kind is not Partner.NONE]
MARKS = {"SUCCESS": "passed", "FAILURE": "failed", "NOT_EXERCISED": "absent", "AGENT_FAULT": "failed"}


def first_cases(words: list[str]) -> list[Playable]:
    """The cases that the words mean; without words, the first of each scenario."""
    library = open_library()
    if words:
        return list(library.choose(words))
    first: dict[str, Playable] = {}
    for playable in library.choose(["all"]):
        first.setdefault(playable.scenario.__name__, playable)
    return list(first.values())


def must_fail(found: Characteristics, kind: Partner) -> bool:
    """Whether a driver blind to that kind must not pass a case of these characteristics."""
    return kind is found.partner or (kind is Partner.SIGN and found.control is TrafficControl.STOP_SIGN)


def play(jobs: dict[str, list[str]], workers: str | None) -> dict[tuple[str, str], dict[str, Any]]:
    """What came of the drives, by case and driver; ``jobs`` has the cases of each driver."""
    found = {}
    for driver, cases in jobs.items():
        with tempfile.TemporaryDirectory() as folder:
            words = ["scenario", "run", *cases, "--agent", driver, "--output", folder]
            with contextlib.redirect_stdout(io.StringIO()):
                main([*words, *(["--workers", workers] if workers else [])])
            for path in Path(folder).glob(f"latest/{driver.replace(':', '-')}/*/result.json"):
                result = json.loads(path.read_text("utf-8"))["case"]
                found[result["id"], driver] = result
        print(f"played: {driver}, {len(cases)} cases", file=sys.stderr)
    return found


def matrix(playables: list[Playable], driver: str | None, wanted: str | None, workers: str | None) -> list[list[str]]:
    """A row a case: its id, its partner, the verdict of the sighted driver and of each blind one."""
    jobs: dict[str, list[str]] = defaultdict(list)
    for one in playables:
        of = driver or one.scenario.reference
        seen = characteristics_of(one.case, one.scenario)
        jobs[of].append(one.case.name)
        for kind in KINDS:
            if (
                wanted is None
                or f"{kind.value}s" in wanted.split(",")
                or (wanted == "partner" and must_fail(seen, kind))
            ):
                jobs[f"{of}:no-{kind.value}s"].append(one.case.name)
    found = play(jobs, workers)
    rows = []
    for one in playables:
        of = driver or one.scenario.reference
        seen = characteristics_of(one.case, one.scenario)
        row = [one.case.name, seen.partner.value, cell(found.get((one.case.name, of)), must_pass=True)]
        for kind in KINDS:
            result = found.get((one.case.name, f"{of}:no-{kind.value}s"))
            row.append(cell(result, must_pass=not must_fail(seen, kind)))
        rows.append(row)
    return rows


def cell(result: dict[str, Any] | None, *, must_pass: bool) -> str:
    """A verdict in a word, in capitals where it is not as it must be; the partner's cells have a star."""
    if result is None:
        return ""
    verdict = MARKS.get(result["verdict"], result["verdict"].lower())
    if must_pass is not (verdict == "passed"):
        print(f"{result['id']} with {result['agent']}: {result['verdict']}: {result['message']}", file=sys.stderr)
        return verdict.upper()
    return verdict if must_pass else f"{verdict} *"


def table(rows: list[list[str]], *, markdown: bool) -> str:
    """The matrix as text."""
    heads = ["case", "partner", SIGHTED, *(f"no {kind.value}s" for kind in KINDS)]
    if markdown:
        return "\n".join(f"| {' | '.join(row)} |" for row in [heads, ["---"] * len(heads), *rows])
    widths = [max(len(row[column]) for row in [heads, *rows]) + 2 for column in range(len(heads))]
    lines = ["".join(text.ljust(width) for text, width in zip(row, widths, strict=True)) for row in [heads, *rows]]
    return "\n".join(line.rstrip() for line in lines)


def run() -> int:
    """Play and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="*")
    parser.add_argument("--driver", help="in place of each scenario's reference driver")
    parser.add_argument("--blind", help="only these columns: walkers, cyclists, …, or `partner`")
    parser.add_argument("--workers")
    parser.add_argument("--markdown", action="store_true")
    given = parser.parse_args()
    rows = matrix(first_cases(given.what), given.driver, given.blind, given.workers)
    print(table(rows, markdown=given.markdown))
    wrong = [text for row in rows for text in row[2:] if text.isupper()]
    print(
        f"\n{len(rows)} cases, {sum(bool(t) for row in rows for t in row[2:])} drives, {len(wrong)} not as they must be"
    )
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(run())
