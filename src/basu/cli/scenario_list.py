"""``basu scenario list``: what there is to play, its parameters and its places; asks no simulator."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import argparse


def add_list_options(command: argparse.ArgumentParser) -> None:
    """What ``basu scenario list`` may be told."""
    command.add_argument(
        "what", nargs="*", metavar="WHAT", help="only these, in full: a type, a group, a case, FILE.xml (default: all)"
    )
    command.add_argument(
        "--scenarios",
        action="append",
        default=[],
        metavar="FILE",
        help="your own: FILE.py with classes or FILE.xml with cases; each brings the other of the same stem",
    )
    command.add_argument("--json", action="store_true", help="as JSON, in full")


def list_scenarios(arguments: argparse.Namespace) -> int:
    """Show scenarios by group, with their parameters and cases."""
    from basu.scenarios.cases import files_among, open_library  # noqa: PLC0415 - every scenario, not for `--help`
    from basu.scenarios.listing import as_json, as_text, listed  # noqa: PLC0415 - likewise

    words: list[str] = arguments.what
    found = listed(open_library([*arguments.scenarios, *files_among(words)]), words)
    print(json.dumps(as_json(found), indent=2) if arguments.json else "\n".join(as_text(found, full=bool(words))))
    return 0
