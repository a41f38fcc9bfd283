"""``basu scenario list``: scenarios by group, with their parameters and cases."""

from __future__ import annotations

import argparse
import json

from basu.errors import UserError
from basu.scenarios.cases import files_among, open_library
from basu.scenarios.listing import as_json, as_text, listed


def run(arguments: argparse.Namespace) -> int:
    """Show scenarios by group, with their parameters and cases."""
    words: list[str] = arguments.what
    where = [_condition(text) for text in arguments.where]
    found = listed(open_library([*arguments.scenarios, *files_among(words)]), words, where)
    full = bool(words or where)
    print(json.dumps(as_json(found), indent=2) if arguments.json else "\n".join(as_text(found, full=full)))
    return 0


def _condition(text: str) -> tuple[str, str]:
    """A field and its value.

    Raises:
        UserError: it is no FIELD=VALUE.
    """
    field, sign, value = text.partition("=")
    if not (field and sign and value):
        raise UserError(f"--where {text}: it must be FIELD=VALUE, such as --where lighting=dark")
    return field, value
