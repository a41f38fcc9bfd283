"""The maps a server offers: found by name, made ready once, and kept for the next load."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from linden.errors import Refusal, UserError
from linden.maps.facts import MapFacts
from linden.maps.reading import NO_WALLS, MapReading, read

HOME_MAP = "Linden"
HOME_MAPS = frozenset({HOME_MAP, "Linden_thesis"})
"""Maps of Linden; the second has no traffic lights, as the map of the thesis."""
GENERATED_MAP = "OpenDriveMap"
"""The name under which CARLA loads what ``generate_opendrive_world`` sent."""

_PACKAGED = Path(__file__).parent.parent / "data"
MOST_KEPT = 2
"""Maps of files that stay in memory, a town takes 30 MB: the one that is loaded and the one before."""

_FOLDERS = ("/Game/Carla/Maps/", "Carla/Maps/")
"""How CARLA writes a map's name: the first when it lists them, the second in the map's info."""


class Walls(NamedTuple):
    """Walls of one height over the feet (N, 2, 3) of their pieces, from and to, m."""

    feet_m: NDArray[np.float64] = NO_WALLS
    height_m: float = 0.0


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LoadedMap(MapFacts):
    """A map made ready to be driven on.

    Attributes:
        name: without a folder.
        text: the OpenDRIVE text, word for word as it was read.
        walls: beside its roads.
    """

    name: str
    text: str
    walls: Walls = field(default_factory=Walls)

    @property
    def full_name(self) -> str:
        """The name as the client knows it."""
        return _FOLDERS[1] + self.name


class Reader(Protocol):
    """Reads OpenDRIVE texts: :func:`linden.maps.reading.read`, or a cache of what it returned."""

    def __call__(self, text: str, walls_beyond_m: float | None = None, /) -> MapReading:
        """Return what a text says, with walls where a distance is given.

        Raises:
            UserError: the text is no OpenDRIVE that can be used.
        """
        ...


class MapLibrary:
    """The packaged maps, those of the folders a user named, and what clients sent."""

    def __init__(self, folders: Iterable[Path] = (), reader: Reader = read) -> None:
        """Look for maps; the files are read when they are loaded.

        Args:
            folders: where to look, beside the packaged maps.
            reader: reads OpenDRIVE texts.

        Raises:
            UserError: a folder does not exist or holds no map.
        """
        self._files = {file.stem: file for file in _PACKAGED.glob("*.xodr")}
        for folder in folders:
            found = sorted(folder.glob("*.xodr"))
            if not found:
                problem = "holds no .xodr file" if folder.is_dir() else "is not a folder"
                raise UserError(f"--maps {folder} {problem}; name a folder of OpenDRIVE maps")
            self._files.update({file.stem: file for file in found})
        self._read = reader
        self._loaded: dict[str, LoadedMap] = {}
        self._sent: tuple[str, Walls] | None = None  # what a client sent, once another map has taken its place

    def names(self) -> list[str]:
        """Return the names of all maps as ``get_available_maps`` lists them."""
        return [_FOLDERS[0] + name for name in sorted(self._files)]

    def load(self, name: str) -> LoadedMap:
        """Return a map by any of its names, ready, and keep it.

        Raises:
            Refusal: there is none of that name, or its file cannot be used.
        """
        found = self.ready(name) or self.make(name)
        self.keep(found)
        return found

    def ready(self, name: str) -> LoadedMap | None:
        """Return a map by any of its names, None where it is not ready yet.

        Raises:
            Refusal: there is none of that name.
        """
        bare = _bare(name)
        is_sent = bare == GENERATED_MAP and self._sent is not None
        if bare not in self._loaded and bare not in self._files and not is_sent:
            raise Refusal(f"Map '{name}' not found; this server has: {', '.join(sorted(self._files))}")
        return self._loaded.get(bare)

    def make(self, name: str) -> LoadedMap:
        """Return a map of a file or of a client's text, made ready; changes nothing, so that any thread may call it.

        Raises:
            Refusal: its file cannot be used.
        """
        bare = _bare(name)
        try:
            if bare == GENERATED_MAP and self._sent is not None:
                text, walls = self._sent
            else:
                text, walls = self._files[bare].read_text("utf-8"), Walls()
            return LoadedMap(name=bare, text=text, walls=walls, **vars(self._read(text).facts))
        except (OSError, UnicodeDecodeError, UserError) as error:
            raise Refusal(f"Map '{name}' cannot be read: {error}") from error

    def keep(self, made: LoadedMap) -> None:
        """Keep a map for the next load of its name: the maps of files that were loaded last, and a client's last text.

        A text is kept whole, and what was read of it until another map takes its place: that may be hundreds of MB.
        """
        self._loaded.pop(made.name, None)
        sent = made if made.name == GENERATED_MAP else self._loaded.pop(GENERATED_MAP, None)
        if sent is not None:
            self._sent = sent.text, sent.walls
        self._loaded[made.name] = made
        for name in list(self._loaded)[:-MOST_KEPT]:
            del self._loaded[name]

    def from_opendrive(self, text: str, *, wall_height_m: float = 0.0, beyond_m: float = 0.0) -> LoadedMap:
        """Return a map of a text that a client sent; changes nothing, so that any thread may call it.

        Args:
            text: the OpenDRIVE text.
            wall_height_m: of walls beside the roads; none are built where it is not positive.
            beyond_m: how far outside of driving lanes they stand.

        Raises:
            Refusal: the text is no OpenDRIVE that can be used.
        """
        try:
            reading = self._read(text, beyond_m if wall_height_m > 0.0 else None)
        except UserError as error:
            raise Refusal(f"the OpenDRIVE text cannot be used: {error}") from error
        walls = Walls(reading.wall_feet_m, max(0.0, wall_height_m))
        return LoadedMap(name=GENERATED_MAP, text=text, walls=walls, **vars(reading.facts))


def _bare(name: str) -> str:
    return name.removeprefix(_FOLDERS[0]).removeprefix(_FOLDERS[1]).removesuffix(".xodr")
