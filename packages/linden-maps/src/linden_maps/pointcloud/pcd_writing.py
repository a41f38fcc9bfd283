"""Writer of PCD files, one cloud at a time: binary; x, y, z and optionally label."""

from pathlib import Path
from types import TracebackType

import numpy as np
from typing_extensions import Self

from linden_maps.output import unwritable_file
from linden_maps.pointcloud.cloud import Cloud

_HEAD = """# .PCD v0.7 - Point Cloud Data file format
# {remark}
VERSION 0.7
FIELDS {fields}
SIZE {sizes}
TYPE {types}
COUNT {ones}
WIDTH {points}
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS {points}
DATA binary
"""
_DIGITS = 12
"""Of the longest number of points that a head has room for."""


class PcdWriter:
    """Writes a file of points without knowing their number beforehand. The file appears when it is complete.

    Attributes:
        points: how many were written.
    """

    def __init__(self, file: Path, remark: str, *, labelled: bool = False) -> None:
        """Begin a file; ``remark`` becomes a line of its head."""
        self.points = 0
        self._file, self._remark = file, remark
        self._names = ("x", "y", "z", "label") if labelled else ("x", "y", "z")
        self._part = file.with_name(f"{file.name}.part")
        try:
            self._stream = self._part.open("wb")
        except OSError as error:
            raise unwritable_file(file, error) from None

    def __enter__(self) -> Self:
        self._stream.write(self._head())
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        try:
            with self._stream:
                if kind is None:
                    self._stream.seek(0)
                    self._stream.write(self._head())
            if kind is None:
                self._part.replace(self._file)
        except OSError as problem:
            raise unwritable_file(self._file, problem) from error
        finally:
            self._part.unlink(missing_ok=True)

    def write(self, cloud: Cloud) -> None:
        """Append points, with labels where the file has labels.

        Raises:
            UserError: the disk is full, or the like.
        """
        labelled = "label" in self._names
        rows = np.empty(len(cloud.points_m), [(name, "<u4" if name == "label" else "<f4") for name in self._names])
        for axis, name in enumerate("xyz"):
            rows[name] = cloud.points_m[:, axis]
        if labelled:
            rows["label"] = cloud.label
        try:
            rows.tofile(self._stream)
        except OSError as error:
            raise unwritable_file(self._file, error) from None
        self.points += len(rows)

    def _head(self) -> bytes:
        """Return the head, as long as it is for any number of points: the remark is followed by spaces."""
        room = " " * (2 * (_DIGITS - len(str(self.points))))
        whole = _HEAD.format(
            remark=f"{self._remark}{room}",
            fields=" ".join(self._names),
            sizes=" ".join("4" for _ in self._names),
            types=" ".join("U" if name == "label" else "F" for name in self._names),
            ones=" ".join("1" for _ in self._names),
            points=self.points,
        )
        return whole.encode("ascii")
