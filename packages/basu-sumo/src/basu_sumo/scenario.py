"""The scenario that SUMO is started with: a finished .sumocfg, the agent's folder, or one made of the town's map."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
import xml.etree.ElementTree as ET  # it writes only
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import basu
from basu.errors import UserError
from basu.files import places

if TYPE_CHECKING:
    from collections.abc import Sequence

DEFAULT_HOUR = 9.5  # of a demand for a route without a timetable
LIMIT_S = 600.0  # a network of Linden takes 5 s
FORMAT = 3  # of the folders that `linden map sumo` writes: an older one that is kept is made again


class RouteStop(NamedTuple):
    """A stop of the route, CARLA's frame."""

    id: str
    name: str
    x_m: float
    y_m: float


class Wanted(NamedTuple):
    """The demand that is to be made."""

    hour: float = DEFAULT_HOUR
    scale: float = 1.0
    stops: tuple[RouteStop, ...] = ()
    has_riders: bool = True  # persons that wait at the stops for the vehicle under test


ANY = Wanted()


def named_folder(folder: str, town: str, beside: Path | None) -> Path | None:
    """Return the folder that an agent's ``config()`` names; None where it is the town's own, still to be made.

    Raises:
        UserError: it is not there, and bears another name than the town.
    """
    for place in places(beside):
        if (place / folder).is_dir():
            return place / folder
    if Path(folder).name.casefold() == town.casefold():
        return None
    looked = ", ".join(str(place) for place in places(beside))
    raise UserError(
        f"the agent's SUMO folder '{folder}' was not found (looked in {looked}); write one with "
        f"`linden map sumo {town} -o {folder}`, or run with --sumo none"
    )


def config_in(folder: Path, *, is_random: bool) -> Path:
    """Return the one configuration of a folder; the one without a demand for random trips.

    Raises:
        UserError: it has none, or several.
    """
    found = sorted(folder.glob("*.sumocfg"))
    empty = [path for path in found if path.name.endswith(".empty.sumocfg")]
    full = [path for path in found if path not in empty]
    chosen = (empty or full) if is_random else full
    if len(chosen) != 1:
        said = "no .sumocfg" if not chosen else f"{len(chosen)} .sumocfg files"
        raise UserError(f"the SUMO folder {folder} has {said}; name one file with --sumo FILE.sumocfg")
    return chosen[0]


def made_of(opendrive: str | None, town: str, seed: int, linden: Sequence[str], wanted: Wanted = ANY) -> Path:
    """The folder with a network and a demand of a town's map, made by ``linden map sumo`` where it is not kept yet.

    Without ``opendrive`` the map is the built-in one of the town.

    ``linden`` is the command that starts it.

    Raises:
        UserError: it cannot be made.
    """
    said = f"{basu.__version__} {FORMAT}\n{seed}\n{town}\n{wanted!r}\n{opendrive}"
    key = hashlib.sha256(said.encode()).hexdigest()[:16]
    folder = _cache() / f"{town}-{key}"
    if folder.is_dir():
        return folder
    folder.parent.mkdir(parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(prefix=f".{town}-", dir=folder.parent))
    try:
        map_file, made = Path(town), draft / "made"
        if opendrive is not None:
            map_file = draft / f"{town}.xodr"
            map_file.write_text(opendrive, encoding="utf-8")
        options = ["--seed", str(seed), "--hour", f"{wanted.hour!r}", "--scale", f"{wanted.scale!r}"]
        if wanted.stops:
            (draft / "stops.xml").write_bytes(_stops_xml(wanted.stops))
            options += ["--stops", str(draft / "stops.xml")]
        if not wanted.has_riders:
            options.append("--no-riders")
        _make(map_file, made, options, linden)
        made.rename(folder)
    except OSError as error:
        if not folder.is_dir():  # another run has made it meanwhile
            raise UserError(
                f"cannot write {folder}: {error.strerror}; set XDG_CACHE_HOME to a folder of yours"
            ) from error
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    return folder


def _stops_xml(stops: Sequence[RouteStop]) -> bytes:
    """Return the stops as a route file has them."""
    root = ET.Element("routes")
    for stop in stops:
        ET.SubElement(root, "stop", {"id": stop.id, "name": stop.name, "x": f"{stop.x_m!r}", "y": f"{stop.y_m!r}"})
    text: bytes = ET.tostring(root, encoding="utf-8")
    return text


def _make(map_file: Path, folder: Path, options: Sequence[str], linden: Sequence[str]) -> None:
    command = [*linden, "map", "sumo", str(map_file), "-o", str(folder), *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)  # noqa: S603 - ours
    if not list(folder.glob("*.sumocfg")):  # an exit status of 1 may say that the network fits but for a lane
        said = (done.stderr.strip().splitlines() or [f"exit status {done.returncode}"])[-1]
        raise UserError(f"no SUMO network could be made of {map_file.stem}: {said.removeprefix('linden: ')}")


def _cache() -> Path:
    """Return where scenario folders are kept between runs."""
    given = os.environ.get("XDG_CACHE_HOME")
    return (Path(given) if given else Path.home() / ".cache") / "basu" / "sumo"
