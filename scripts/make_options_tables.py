"""Fill the tables of options in docs/how-to/runs.md from the models: `python scripts/make_options_tables.py [--check]`.

Each stands in the page between ``<!-- NAME -->`` and ``<!-- /NAME -->``; the rest of the page is written by hand.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

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


def main() -> int:
    """Write the page, or say that it is not what the code says."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; fail if the page is not up to date")
    check = parser.parse_args().check
    before = PAGE.read_text("utf-8")
    after = before
    for name, model in MODELS.items():
        after = replaced(after, name, table(model))
    if not check:
        PAGE.write_text(after, "utf-8")
    elif after != before:
        print("docs/how-to/runs.md is out of date; run `python scripts/make_options_tables.py`", file=sys.stderr)
        return 1
    return 0


def replaced(page: str, name: str, text: str) -> str:
    """Return the page with ``text`` between the marks of ``name``."""
    found, number = re.subn(
        f"(<!-- {re.escape(name)} -->\n).*?(<!-- /{re.escape(name)} -->)",
        lambda match: f"{match[1]}\n{text}\n\n{match[2]}",
        page,
        flags=re.DOTALL,
    )
    if number != 1:
        raise SystemExit(f"{PAGE} has {number} places for '{name}'; it must have one")
    return found


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
    sys.exit(main())
