"""``basu truth evaluate``: the scores of a detector on the console, and as a file."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from basu.errors import UserError
from basu.files import write_bytes
from basu_truth.evaluating.detections import read_detections
from basu_truth.evaluating.scoring import evaluate
from basu_truth.evaluating.track_scores import has_hota
from basu_truth.export_command import write_export
from basu_truth.truth import TRUTH_FILE, Truth, read_truth

if TYPE_CHECKING:
    import argparse

    from basu_truth.evaluating.scoring import Evaluation

WITHOUT_HOTA = "HOTA was not computed, because the package trackers is missing; pip install 'basu-truth[hota]'"


def run(arguments: argparse.Namespace) -> int:
    """Score a detector's output.

    Raises:
        UserError: the truth or the detections cannot be read, or do not belong together.
        SimulatorError: a simulator went away.
    """
    if arguments.least is not None and arguments.least < 1:
        raise UserError(f"--least is {arguments.least}; it is a number of pixels or points, 1 or more")
    truth = _truth(arguments)
    found = evaluate(
        truth, read_detections(arguments.detections, truth), sensor=arguments.sensor, least=arguments.least
    )
    print(table(found))
    if any("MOTA" in row.scores for row in found.rows) and not has_hota():
        print(WITHOUT_HOTA)
    if arguments.json is not None:
        write_bytes(arguments.json, (json.dumps(found.document(), indent=2) + "\n").encode())
    return 0


def _truth(arguments: argparse.Namespace) -> Truth:
    """Return the truth of an export, or of a run that is replayed now.

    Raises:
        UserError: there is neither.
    """
    folder: Path = arguments.truth
    if (folder / TRUTH_FILE).is_file():
        return read_truth(folder)
    with tempfile.TemporaryDirectory(prefix="basu-truth-") as temporary:
        made = Path(temporary) / "truth"
        write_export(arguments, folder, made, None)
        return read_truth(made)


def table(found: Evaluation) -> str:
    """Return the scores as a table for the console."""
    names = list(dict.fromkeys(name for row in found.rows for name in row.scores))
    head = f"{'':<12}{'':<20}{'objects':>8}" + "".join(f"{name:>9}" for name in names)
    lines = [f"{found.run}: {found.form} detections, {found.sensor}", head]
    for row in found.rows:
        cells = "".join(f"{_number(row.scores.get(name)):>9}" for name in names)
        lines.append(f"{row.by:<12}{row.name:<20}{row.objects:>8}{cells}")
    return "\n".join(lines)


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f}"
