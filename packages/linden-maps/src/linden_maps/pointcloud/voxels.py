"""The voxel filter: one point for each cell that any fell into, the mean of those, however many clouds there were.

Cells lie at whole multiples of their width from the origin. Memory is what the table of cells takes, and that is held
within a limit: tiles of the plane that were not met for longest wait on the disk.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from linden.errors import UserError
from linden_maps.pointcloud.cells import Cells, Located, empty, insert, locate, middles, packed, refill
from linden_maps.pointcloud.cloud import Cloud

MOST_PLACES = 1 << 24
"""Places of all tables in memory together; 28 bytes each, so 470 MB."""
_FEWEST_PLACES = 1 << 12
_FULL = 0.7  # from here on, linear probing takes long


class _Tile(NamedTuple):
    cells: Cells
    used: int


class VoxelGrid:
    """Cells of one width over the whole world.

    Attributes:
        cells: how many have a point.
    """

    def __init__(self, voxel_m: float, folder: Path, most_places: int = MOST_PLACES) -> None:
        """Begin an empty grid, with a folder of its own for what there is no room for in memory."""
        self._voxel_m, self._folder, self._most_places = voxel_m, folder, most_places
        self._tiles: dict[int, _Tile] = {}  # the one that was met last is the last
        self._away: dict[int, Path] = {}
        self._places = 0
        self.cells = 0

    @property
    def bytes_in_memory(self) -> int:
        """What the tables take."""
        return sum(column.nbytes for tile in self._tiles.values() for column in tile.cells)

    def add(self, cloud: Cloud) -> None:
        """Add points in the map's frame.

        Raises:
            UserError: a point is too far away to have a cell.
        """
        located = self._located(cloud)
        label = np.zeros(len(cloud.points_m), np.uint32) if cloud.label is None else cloud.label
        order = np.argsort(located.tile, kind="stable")
        in_order = located.tile[order]
        starts = np.flatnonzero(np.append(True, in_order[1:] != in_order[:-1])) if len(order) else order
        for rows, number in zip(np.split(order, starts[1:]), in_order[starts].tolist(), strict=False):
            tile = self._with_room(number, len(rows))
            new = insert(tile.cells, rows, located.key, located.steps, label)
            self._tiles[number] = _Tile(tile.cells, tile.used + new)
            self.cells += new
            self._put_away()

    def clouds(self) -> Iterator[Cloud]:
        """Give what is left of all points, a tile at a time, from west to east; the grid is empty afterwards."""
        for number in sorted({*self._tiles, *self._away}):
            cells = packed(self._taken(number).cells)
            yield Cloud(middles(cells, number, self._voxel_m), cells.label)

    def _located(self, cloud: Cloud) -> Located:
        count = len(cloud.points_m)
        located = Located(np.empty(count, np.int64), np.empty(count, np.int64), np.empty((count, 3), np.uint32))
        lost = locate(np.ascontiguousarray(cloud.points_m), self._voxel_m, *located)
        if lost >= 0:
            at = ", ".join(f"{value:g}" for value in cloud.points_m[lost])
            raise UserError(f"a point at ({at}) m is too far away for cells of {self._voxel_m:g} m; is it in metres?")
        return located

    def _with_room(self, number: int, more: int) -> _Tile:
        """Return a tile, as the one met last, with room for more cells."""
        tile = self._taken(number)
        places = len(tile.cells.key)
        while (tile.used + more) > _FULL * places:
            places *= 2
        if places != len(tile.cells.key):
            bigger = empty(places)
            refill(tile.cells, bigger)
            tile = _Tile(bigger, tile.used)
        self._tiles[number] = tile
        self._places += places
        return tile

    def _taken(self, number: int) -> _Tile:
        """Return a tile from memory, from the disk, or a new one; it is in neither afterwards."""
        if number in self._tiles:
            tile = self._tiles.pop(number)
            self._places -= len(tile.cells.key)
            return tile
        if number not in self._away:
            return _Tile(empty(_FEWEST_PLACES), 0)
        file = self._away.pop(number)
        with np.load(file, allow_pickle=False) as kept:
            cells = Cells(*(kept[name] for name in Cells._fields))
        file.unlink()
        table = empty(max(_FEWEST_PLACES, 1 << int(len(cells.key) / _FULL).bit_length()))
        refill(cells, table)
        return _Tile(table, len(cells.key))

    def _put_away(self) -> None:
        """Write the tiles that were not met for longest to the disk, until the others fit."""
        while self._places > self._most_places and len(self._tiles) > 1:
            number = next(iter(self._tiles))
            cells = packed(self._taken(number).cells)
            file = self._folder / f"{number}.npz"
            try:
                np.savez(file, **cells._asdict())
            except OSError as error:
                raise UserError(f"no room for what does not fit into memory: {error}; set TMPDIR elsewhere") from None
            self._away[number] = file
