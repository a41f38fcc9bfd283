"""Finds the files that a run names: route files, sensor sets, folders."""

from __future__ import annotations

from pathlib import Path

import basu
from basu.errors import UserError

PACKAGE_FOLDER = Path(basu.__file__).parent


def places(beside: Path | None) -> tuple[Path, ...]:
    """Where a relative name is looked for, in order: here, beside the agent's file, among what BASU brings."""
    beside_folder = () if beside is None else (beside.resolve().parent,)
    return (Path.cwd(), *beside_folder, PACKAGE_FOLDER)


def find(name: str, what: str, beside: Path | None = None) -> Path:
    """The first place that has ``name``; ``beside`` is the agent's file.

    Raises:
        UserError: none has it; says where it was looked for.
    """
    for place in places(beside):
        if (place / name).exists():
            return place / name
    looked = ", ".join(str(place) for place in ((Path(name),) if Path(name).is_absolute() else places(beside)))
    raise UserError(f"{what} '{name}' was not found (looked in {looked}); `basu list` shows what comes with BASU")
