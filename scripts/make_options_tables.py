"""Fill the tables of options in docs/how-to/runs.md from the models: `python scripts/make_options_tables.py [--check]`.

Each stands in the page between ``<!-- NAME -->`` and ``<!-- /NAME -->``; the rest of the page is written by hand.
"""

from __future__ import annotations

import sys
from pathlib import Path

from generated_page import replaced, write_or_check

from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.running.scenario_runs.options import ScenarioOptions
from basu.settings.command_line import default_text
from basu.settings.option import Field, bounds, fields_of

PAGE = Path(__file__).parent.parent / "docs" / "how-to" / "runs.md"
MODELS = {
    "options of basu run": RunOptions,
    "scoring options": Scoring,
    "options of basu scenario run": ScenarioOptions,
}


def files() -> dict[Path, str]:
    """Return the page with its tables."""
    text = PAGE.read_text("utf-8")
    for name, model in MODELS.items():
        text = replaced(text, name, table(model))
    return {PAGE: text}


def table(model: type) -> str:
    """Return a model's options as a table, in the order of the help page."""
    rows = ["| option | key | meaning | default |", "|---|---|---|---|"]
    for field in fields_of(model):
        notes = [note for note in (field.unit and f"in {field.unit}", bounds(field.option)) if note]
        meaning = ", ".join([field.option.help, *notes]) + ("" if field.option.repeats else " *")
        rows.append(f"| {_typed(field)} | `{field.name}` | {meaning.replace('|', '/')} | {_usual(field)} |")
    return "\n".join(rows)


def _typed(field: Field) -> str:
    if field.option.in_files:
        return "only in `--scoring`"
    metavar = f" {field.metavar.replace('|', '/')}" if field.metavar else ""
    return f"`{field.metavar}`" if field.option.positional else f"`{field.flag}{metavar}`"


def _usual(field: Field) -> str:
    return default_text(field) or ("no" if field.default is False else "none")


if __name__ == "__main__":
    sys.exit(write_or_check(__file__, __doc__, files))
