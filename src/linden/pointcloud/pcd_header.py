"""The head of a PCD file (Point Cloud Library, version 0.7): what its points have and how they are written.

Source: PCL's documentation, "The PCD (Point Cloud Data) file format".
"""

from pathlib import Path
from typing import IO, NamedTuple

import numpy as np

from linden.errors import UserError

ASCII, BINARY, COMPRESSED = "ascii", "binary", "binary_compressed"
_LONGEST_HEAD_LINES = 100
_KINDS = {"F": "f", "I": "i", "U": "u"}
_WIDTHS = {"F": (4, 8), "I": (1, 2, 4, 8), "U": (1, 2, 4, 8)}


class Header(NamedTuple):
    """What a head says; ``point`` has a column for each field, of several values where COUNT says so."""

    point: np.dtype[np.void]
    points: int
    data: str
    starts_at: int  # byte of the file where the points begin


def read_header(file: Path, stream: IO[bytes]) -> Header:
    """Read the head from the beginning of a stream, and leave the stream where the points begin.

    Raises:
        UserError: it is no PCD file, or one whose points have no x, y and z.
    """
    told: dict[str, list[str]] = {}
    for _ in range(_LONGEST_HEAD_LINES):
        line = stream.readline(4096)
        words = line.decode("ascii", "replace").split()
        if not line:
            break
        if words and not words[0].startswith("#"):
            told[words[0].upper()] = words[1:]
            if words[0].upper() == "DATA":
                return _header(file, told, stream.tell())
    raise UserError(f"{file} is no PCD file: there is no line DATA in its head")


def _header(file: Path, told: dict[str, list[str]], starts_at: int) -> Header:
    try:
        fields, sizes, kinds = told["FIELDS"], [int(size) for size in told["SIZE"]], told["TYPE"]
        counts = [int(count) for count in told.get("COUNT", ["1"] * len(fields))]
        shape = [int(told[name][0]) for name in ("WIDTH", "HEIGHT")]
        points = int(told["POINTS"][0]) if "POINTS" in told else shape[0] * shape[1]
        data = told["DATA"][0].lower()
        point = _point(list(zip(fields, kinds, sizes, counts, strict=True)))
    except (KeyError, IndexError, ValueError) as error:
        raise UserError(f"{file} is no PCD file that can be read: its head is wrong about {error}") from None
    missing = [name for name in "xyz" if name not in fields]
    if missing:
        raise UserError(f"{file} has no field {', '.join(missing)}; it has {' '.join(fields)}")
    if data not in {ASCII, BINARY, COMPRESSED}:
        raise UserError(f"{file} has DATA {data}; known are {ASCII}, {BINARY}, {COMPRESSED}")
    if points < 0 or shape[0] * shape[1] != points:
        raise UserError(f"{file} is broken: WIDTH {shape[0]} x HEIGHT {shape[1]} are not POINTS {points}")
    return Header(point, points, data, starts_at)


def _point(fields: list[tuple[str, str, int, int]]) -> np.dtype[np.void]:
    columns = []
    for number, (name, kind, size, count) in enumerate(fields):
        if kind not in _KINDS or size not in _WIDTHS[kind] or count < 1:
            raise ValueError(f"field {name}: TYPE {kind}, SIZE {size}, COUNT {count}")
        unique = f"{name} {number}" if name == "_" or any(name == other[0] for other in fields[:number]) else name
        columns.append((unique, f"<{_KINDS[kind]}{size}", (count,)))  # "_" is padding, and may come more than once
    return np.dtype(columns)
