"""The table of drives: a JSON-lines journal for each open block, Parquet files for complete blocks, and readers.

A block holds the rows of consecutive numbers of jobs. While a block is open, each row is appended to its journal, a
file of JSON lines. A complete block becomes a Parquet file for each agent, its rows in the order of their numbers; then
its journal is removed. So the files depend on the rows alone, and not on the order in which drives ended. A half line
at a journal's end, which a kill leaves, is dropped, and its drive is driven again.

The driver holds the numbers of open blocks only.
"""

from __future__ import annotations

import errno
import json
import os
import re
import time
from typing import IO, TYPE_CHECKING, Any

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.json as pj
import pyarrow.parquet as pq

from basu.errors import UserError
from basu.files import write_bytes

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from pyarrow.dataset import Dataset

DRIVES, JOURNAL = "drives", "journal"
SYNC_S = 1.0  # of wall time from one sync with the disk to the next
BLOCK_NAME = re.compile(r"block-(\d+)\.(?:parquet|jsonl)")


class Journal:
    """The rows of an open block."""

    def __init__(self, path: Path) -> None:
        """Read what a killed command has left; a half line is cut off.

        Raises:
            UserError: the file cannot be read or written.
        """
        self.path = path
        self.numbers: set[int] = set()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._cut()
            for row in self.rows():
                self.numbers.add(row["number"])
            self._file: IO[bytes] = path.open("ab", buffering=0)  # a row is in the file at once, or not at all
        except OSError as error:
            raise _unwritable(path, error) from error
        self._synced_s = time.monotonic()

    def add(self, row: Mapping[str, Any]) -> None:
        """Append a row; a job that has one is not counted again.

        Raises:
            UserError: the disk is full.
        """
        if row["number"] in self.numbers:
            return
        end = self._file.tell()
        try:
            line = json.dumps(row).encode() + b"\n"
            self._write(line)
            if time.monotonic() - self._synced_s > SYNC_S:
                self.sync()
        except OSError as error:
            os.truncate(self.path, end)
            raise _unwritable(self.path, error) from error
        self.numbers.add(row["number"])

    def _write(self, line: bytes) -> None:
        """Write a line whole.

        Raises:
            OSError: only a part of it found room.
        """
        if self._file.write(line) < len(line):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def sync(self) -> None:
        """Bring what was written to the disk."""
        os.fsync(self._file.fileno())
        self._synced_s = time.monotonic()

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield all rows of the table."""
        if self.path.exists():
            with self.path.open("rb") as file:
                for line in file:
                    yield json.loads(line)

    def close(self) -> None:
        """Sync and close the file."""
        try:
            self.sync()
            self._file.close()
        except OSError as error:
            raise _unwritable(self.path, error) from error

    def _cut(self) -> None:
        """Cut off a half line."""
        if not self.path.exists():
            return
        data = self.path.read_bytes()
        whole = data.rfind(b"\n") + 1
        if whole < len(data):
            os.truncate(self.path, whole)


class DriveTable:
    """The table in a folder, for the one command that writes it."""

    def __init__(self, folder: Path, schema: pa.Schema, block: int, planned: int) -> None:
        """Open it, with what earlier commands have left.

        Raises:
            UserError: a file cannot be read or written.
        """
        self.folder, self.schema, self.block, self.planned = folder, schema, block, planned
        self._complete = {number for number, _ in _blocks(folder / DRIVES, "*/block-*.parquet")}
        self._open: dict[int, Journal] = {}
        for number, path in _blocks(folder / JOURNAL, "block-*.jsonl"):
            self._complete.discard(number)
            self._open[number] = Journal(path)
        for number in list(self._open):
            self._finish(number)

    @property
    def number(self) -> int:
        """The number of rows."""
        return sum(self._size(block) for block in self._complete) + sum(
            len(each.numbers) for each in self._open.values()
        )

    def pending(self, limit: int) -> Iterator[int]:
        """The numbers below ``limit`` of jobs without a row when they are reached, in their order."""
        for block in range(-(-limit // self.block)):
            if block not in self._complete:
                begin = block * self.block
                for number in range(begin, min(begin + self._size(block), limit)):
                    if block in self._complete:
                        break
                    if block not in self._open or number not in self._open[block].numbers:
                        yield number

    def add(self, row: Mapping[str, Any]) -> int | None:
        """Add a row; the number of its block where that is complete now.

        Raises:
            UserError: the disk is full.
        """
        block = row["number"] // self.block
        if block in self._complete:
            return None
        if block not in self._open:
            self._open[block] = Journal(self._journal(block))
        self._open[block].add(row)
        return block if self._finish(block) else None

    def is_complete(self, block: int) -> bool:
        """Whether all rows of a block are written."""
        return block in self._complete

    def rows(self, block: int) -> Iterator[dict[str, Any]]:
        """Return the rows of a complete block, as their files have them."""
        for path in sorted((self.folder / DRIVES).glob(f"*/block-{block:06d}.parquet")):
            agent = path.parent.name.partition("=")[2]
            for row in pq.read_table(path, partitioning=None).to_pylist():
                yield {**row, "agent": agent}

    def cut(self, blocks: int) -> None:
        """Remove all rows behind the first so many blocks."""
        for block in [each for each in self._open if each >= blocks]:
            self._open.pop(block).close()
            self._journal(block).unlink()
            self._remove(block)
        for block in [each for each in self._complete if each >= blocks]:
            self._complete.remove(block)
            self._remove(block)

    def close(self) -> None:
        """Write the rows of open blocks for readers as well; their journals stay, so that the blocks stay open.

        Raises:
            UserError: the disk is full.
        """
        for block, journal in self._open.items():
            journal.close()
            self._write(block, journal)

    def _finish(self, block: int) -> bool:
        """Make Parquet files of a block where all its rows are there."""
        journal = self._open[block]
        if len(journal.numbers) < self._size(block):
            return False
        journal.close()
        self._write(block, journal)
        journal.path.unlink()
        del self._open[block]
        self._complete.add(block)
        return True

    def _write(self, block: int, journal: Journal) -> None:
        """Write the files of a block."""
        table = _read_rows(journal, self.schema)
        for agent in pc.unique(table["agent"]).to_pylist():
            own = table.filter(pc.equal(table["agent"], agent)).drop_columns(["agent"]).combine_chunks()
            path = self.folder / DRIVES / f"agent={agent}" / f"block-{block:06d}.parquet"
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise _unwritable(path, error) from error
            write_bytes(path, _parquet(own))

    def _remove(self, block: int) -> None:
        for path in (self.folder / DRIVES).glob(f"*/block-{block:06d}.parquet"):
            path.unlink()

    def _size(self, block: int) -> int:
        return min(self.block, self.planned - block * self.block)

    def _journal(self, block: int) -> Path:
        return self.folder / JOURNAL / f"block-{block:06d}.jsonl"


def open_drives(folder: Path) -> Dataset:
    """The table in the folder of a campaign, for reading.

    Raises:
        UserError: there is none.
    """
    import pyarrow.dataset as ds  # noqa: PLC0415 - imports pandas, for 0.5 s; a command that writes rows does without

    if not any((folder / DRIVES).glob("*/block-*.parquet")):
        raise UserError(f"{folder} holds no drives of a campaign yet; name a folder that `basu campaign run` has left")
    partitions = ds.partitioning(pa.schema([("agent", pa.string())]), flavor="hive")
    return ds.dataset(folder / DRIVES, format="parquet", partitioning=partitions, exclude_invalid_files=False,
                      ignore_prefixes=["."])  # fmt: skip


def read_drives(folder: Path, columns: list[str] | None = None) -> pa.Table:
    """The rows of a campaign in the order of their numbers, or some columns of them.

    Raises:
        UserError: there is no table.
    """
    wanted = None if columns is None else list(dict.fromkeys(["number", *columns]))
    table = open_drives(folder).to_table(columns=wanted)
    return table.take(pc.sort_indices(table, sort_keys=[("number", "ascending")]))


def journal_rows(folder: Path) -> Iterator[dict[str, Any]]:
    """The rows of open blocks, read while another process may write them."""
    for _, path in _blocks(folder / JOURNAL, "block-*.jsonl"):
        try:
            data = path.read_bytes()
        except FileNotFoundError:  # the block is complete now
            continue
        for line in data[: data.rfind(b"\n") + 1].splitlines():
            yield json.loads(line)


def _blocks(folder: Path, pattern: str) -> Iterator[tuple[int, Path]]:
    """The numbers of blocks with files of a pattern."""
    for path in sorted(folder.glob(pattern)):
        found = BLOCK_NAME.fullmatch(path.name)
        if found is not None:
            yield int(found[1]), path


def _read_rows(journal: Journal, schema: pa.Schema) -> pa.Table:
    """The rows of a journal in the order of their numbers. Arrow's reader is four times as fast as Python's.

    It works in this thread alone: each of Arrow's threads keeps memory of its own, and the driver would grow with them.
    """
    options = pj.ParseOptions(explicit_schema=schema, unexpected_field_behavior="ignore")
    try:
        found = pj.read_json(journal.path, pj.ReadOptions(use_threads=False), options)
        found = found.select(schema.names).cast(schema)
    except (pa.ArrowInvalid, KeyError):  # NaN, which Arrow takes for no JSON, or a column that no row has
        found = pa.Table.from_pylist(list(journal.rows()), schema=schema)
    return found.take(pc.sort_indices(found, sort_keys=[("number", "ascending")]))


def _parquet(table: pa.Table) -> bytes:
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd")
    data: bytes = sink.getvalue().to_pybytes()
    return data


def _unwritable(path: Path, error: OSError) -> UserError:
    return UserError(
        f"{path} could not be written: {error.strerror}; make room and go on with --resume, which loses no drive"
    )
