"""PCD files in every form that PCL writes, made without our reader or writer."""

from pathlib import Path

import numpy as np

Columns = dict[str, np.ndarray]


def pcd(file: Path, columns: Columns, data: str, *, padding: bool = False) -> Path:
    """Write columns (N,) as a file; with padding, as PCL writes points whose structs have gaps."""
    count = len(next(iter(columns.values())))
    fields = list(columns.items())
    if padding:
        fields.insert(3, ("_", np.zeros((count, 4), np.uint8)))
    names = [name for name, _ in fields]
    values = [column for _, column in fields]
    kinds = [column.dtype.kind.upper() for column in values]
    sizes = [column.dtype.itemsize for column in values]
    counts = [column[0].size for column in values]
    head = [
        "# .PCD v0.7 - Point Cloud Data file format", "VERSION 0.7", "FIELDS " + " ".join(names),
        "SIZE " + " ".join(map(str, sizes)), "TYPE " + " ".join(kinds), "COUNT " + " ".join(map(str, counts)),
        f"WIDTH {count}", "HEIGHT 1", "VIEWPOINT 0 0 0 1 0 0 0", f"POINTS {count}", f"DATA {data}",
    ]  # fmt: skip
    file.write_bytes("\n".join(head).encode() + b"\n" + _BODIES[data](values, count))
    return file


def _ascii(values: list[np.ndarray], count: int) -> bytes:
    def row(number: int) -> str:
        return " ".join(repr(value) for column in values for value in np.atleast_1d(column[number]).tolist())

    return "".join(f"{row(number)}\n" for number in range(count)).encode()


def _binary(values: list[np.ndarray], count: int) -> bytes:
    return b"".join(column[row].tobytes() for row in range(count) for column in values)


def _compressed(values: list[np.ndarray], _count: int) -> bytes:
    raw = b"".join(column.tobytes() for column in values)
    packed = lzf(raw)
    return np.array([len(packed), len(raw)], "<u4").tobytes() + packed


_BODIES = {"ascii": _ascii, "binary": _binary, "binary_compressed": _compressed}


def lzf(raw: bytes) -> bytes:
    """Pack, greedily: copies of what came before where three bytes at least agree, literals otherwise."""
    out, literals, last, at = bytearray(), bytearray(), dict[bytes, int](), 0

    def flush() -> None:
        for start in range(0, len(literals), 32):
            part = literals[start : start + 32]
            out.append(len(part) - 1)
            out.extend(part)
        literals.clear()

    while at < len(raw):
        seen = last.get(raw[at : at + 3], -1) if at + 3 <= len(raw) else -1
        length = 0
        if seen >= 0 and at - seen <= 8192:
            while length < 264 and at + length < len(raw) and raw[seen + length] == raw[at + length]:
                length += 1
        last[raw[at : at + 3]] = at
        if length < 3:
            literals.append(raw[at])
            at += 1
            continue
        flush()
        back, coded = at - seen - 1, length - 2
        out.extend([(min(coded, 7) << 5) | (back >> 8), *([coded - 7] if coded >= 7 else []), back & 255])
        at += length
    flush()
    return bytes(out)
