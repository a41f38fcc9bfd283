"""The maps that cases bring along: OpenDRIVE files that a server of our own offers beside its own towns."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from basu.errors import ScenarioError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from basu.conditions import SimulatorSpec
    from basu.scenarios.xml_elements import Case


@contextlib.contextmanager
def maps_of(cases: Iterable[Case]) -> Iterator[tuple[Path, ...]]:
    """Yield a temporary folder with the maps of all cases that bring one; no folder where none does.

    Raises:
        ScenarioError: two different maps have one name, or one cannot be read.
    """
    files: dict[str, Path] = {}
    for file in (case.map_file for case in cases if case.map_file is not None):
        if files.setdefault(file.stem, file) != file:
            raise ScenarioError(
                f"{files[file.stem]} and {file} are maps of one name; play their cases one after the other"
            )
    if not files:
        yield ()
        return
    with tempfile.TemporaryDirectory(prefix="basu-maps-") as name:
        try:
            for file in files.values():
                shutil.copyfile(file, Path(name) / file.with_suffix(".xodr").name)
        except OSError as error:
            raise ScenarioError(f"a map cannot be copied ({error}); check the file and the disk") from error
        yield (Path(name),)


def with_maps(spec: SimulatorSpec, folders: tuple[Path, ...]) -> SimulatorSpec:
    """Return the simulator that also offers the maps of folders; a simulator at --host has its own maps."""
    return spec if spec.host is not None else replace(spec, maps=(*spec.maps, *folders))
