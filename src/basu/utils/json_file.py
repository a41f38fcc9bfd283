"""Reads a JSON file that a person wrote or named, and says in a sentence what is wrong with it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from basu.errors import UserError


def read_json(path: Path, what: str, otherwise: str = "") -> Any:  # noqa: ANN401 - whatever stands in the file
    """The document in ``path``.

    ``what`` is what complaints call the file, ``otherwise`` what to do about one that cannot be read.

    Raises:
        UserError: the file cannot be read, or is no JSON.
    """
    advice = f"; {otherwise}" if otherwise else ""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(f"{what} {path} cannot be read: {error.strerror}{advice}") from error
    except ValueError as error:
        raise UserError(f"{what} {path} is no JSON: {error}{advice}") from error
