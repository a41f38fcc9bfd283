"""The packages of optional extras that are checked before a run: what needs them, and how they are installed."""

from __future__ import annotations

import importlib.util
from typing import NamedTuple

from basu.errors import UserError


class Extra(NamedTuple):
    """A package of an extra, and the sentence for a user without it."""

    package: str
    missing: str


def require(extra: Extra) -> None:
    """Check that the package of an extra is installed; it is not imported.

    Raises:
        UserError: it is not.
    """
    if importlib.util.find_spec(extra.package) is None:
        raise UserError(extra.missing)
