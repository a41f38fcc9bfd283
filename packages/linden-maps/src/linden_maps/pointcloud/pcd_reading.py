"""PCD files read in pieces: ascii, binary, binary_compressed. The fields x, y, z and label are kept.

Sources: the Point Cloud Library's documentation, "The PCD (Point Cloud Data) file format", version 0.7; for the
compression of binary_compressed, Marc Lehmann's LibLZF, the comment over ``lzf_decompress``. In LZF a byte below 32
stands before that many literal bytes and one. Any other byte holds a length in its upper three bits (7: the length
continues in the next byte) and, with the byte after it, the distance back to the start of the copy.
"""

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import IO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import kernel
from linden.errors import UserError
from linden_maps.pointcloud.cloud import Cloud

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
        UserError: it is no PCD file, or its points have no x, y and z.
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


U8 = NDArray[np.uint8]


def unpack(packed: U8, size: int) -> U8 | None:
    """Return the ``size`` bytes that were packed, None where ``packed`` is no packing of so many."""
    out = np.empty(size, np.uint8)
    return out if _unpack(packed, out) else None


@kernel
def _unpack(packed: U8, out: U8) -> bool:
    at, made, size = 0, 0, len(out)
    while at < len(packed):
        control = int(packed[at])
        at += 1
        if control < 32:
            length = control + 1
            if at + length > len(packed) or made + length > size:
                return False
            for _ in range(length):
                out[made] = packed[at]
                at += 1
                made += 1
            continue
        length = control >> 5
        if length == 7:
            if at >= len(packed):
                return False
            length += int(packed[at])
            at += 1
        if at >= len(packed):
            return False
        source = made - (((control & 31) << 8) | int(packed[at])) - 1
        at += 1
        if source < 0 or made + length + 2 > size:
            return False
        for _ in range(length + 2):  # byte by byte: a copy may reach into what it makes
            out[made] = out[source]
            source += 1
            made += 1
    return made == size


STRETCH = 1_000_000
"""Points read at once, except of compressed files, which can only be unpacked whole."""


def header_of(file: Path) -> Header:
    """Return what the head of a file says.

    Raises:
        UserError: there is no such file, or it is no PCD file.
    """
    with _opened(file) as stream:
        return read_header(file, stream)


def clouds_of(file: Path, stretch: int = STRETCH) -> Iterator[Cloud]:
    """Give the points of a file, ``stretch`` at a time.

    Raises:
        UserError: it is no PCD file, or broken.
    """
    with _opened(file) as stream:
        header = read_header(file, stream)
        if header.data == ASCII:
            yield from _of_text(file, stream, header, stretch)
        elif header.data == BINARY:
            yield from _of_bytes(file, stream, header, stretch)
        else:
            yield _of_packed(file, stream, header)


def _opened(file: Path) -> IO[bytes]:
    try:
        return file.open("rb")
    except OSError as error:
        raise UserError(f"cannot read {file}: {error.strerror}") from None


def _of_bytes(file: Path, stream: IO[bytes], header: Header, stretch: int) -> Iterator[Cloud]:
    for start in range(0, header.points, stretch):
        count = min(stretch, header.points - start)
        content = stream.read(count * header.point.itemsize)
        if len(content) < count * header.point.itemsize:
            raise _too_short(file, header, start + len(content) // header.point.itemsize)
        points = np.frombuffer(content, header.point)
        yield _cloud({name: points[name][:, 0] for name in header.point.names or ()})


def _of_packed(file: Path, stream: IO[bytes], header: Header) -> Cloud:
    sizes = np.frombuffer(stream.read(8), "<u4")
    size = header.points * header.point.itemsize
    packed = np.frombuffer(stream.read(int(sizes[0]) if len(sizes) == 2 else 0), np.uint8)
    content = unpack(packed, size) if len(sizes) == 2 and len(packed) == sizes[0] and sizes[1] == size else None
    if content is None:
        raise UserError(f"{file} is broken: what is packed in it does not make {header.points} points")
    columns, at = dict[str, NDArray[np.generic]](), 0
    for name in header.point.names or ():  # here the fields lie one after the other
        kind = header.point[name]
        columns[name] = (
            content[at : at + header.points * kind.itemsize].view(kind.base).reshape(header.points, -1)[:, 0]
        )
        at += header.points * kind.itemsize
    return _cloud(columns)


def _of_text(file: Path, stream: IO[bytes], header: Header, stretch: int) -> Iterator[Cloud]:
    width, first = 0, {}
    for name in header.point.names or ():
        first[name] = width
        width += int(np.prod(header.point[name].shape))
    for start in range(0, header.points, stretch):
        count = min(stretch, header.points - start)
        words = b"".join(islice(stream, count)).split()
        if len(words) < count * width:
            raise _too_short(file, header, start + len(words) // width)
        try:
            values = np.array(words, np.float64).reshape(count, width)
        except ValueError as error:
            raise UserError(f"{file} is broken after point {start}: {error}") from None
        yield _cloud({name: values[:, column] for name, column in first.items()})


def _cloud(columns: dict[str, NDArray[np.generic]]) -> Cloud:
    points = np.stack([np.asarray(columns[axis], np.float64) for axis in "xyz"], axis=1)
    return Cloud(points, np.asarray(columns["label"]).astype(np.uint32) if "label" in columns else None)


def _too_short(file: Path, header: Header, there: int) -> UserError:
    return UserError(f"{file} is broken: of its {header.points} points {there} are there")
