"""PCD files read a stretch of points at a time: ascii, binary, binary_compressed; x, y, z and label are kept."""

from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from linden.errors import UserError
from linden.pointcloud.cloud import Cloud
from linden.pointcloud.lzf import unpack
from linden.pointcloud.pcd_header import ASCII, BINARY, Header, read_header

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
