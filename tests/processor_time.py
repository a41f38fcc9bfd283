"""Processor time of the tests, by test and by file: user and system time of a process of tests and of all below it.

``PROCESSOR_TIMES=FOLDER pytest …`` writes it into a folder; ``python tests/processor_time.py FOLDER [EARLIER]`` prints
the files that took most, beside an earlier measurement. Processor time hardly depends on what else the machine does.
"""

import json
import os
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

FOLDER = "PROCESSOR_TIMES"
SHOWN = 30
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


def used_s(of: int | None = None) -> float:
    """Processor time in s of a process (this one by default), its living descendants, and ended ones that were awaited.

    Linux: fields 14 to 17 of /proc/PID/stat, proc(5). A process that leaves its parent no longer counts.
    """
    pids, found = [os.getpid() if of is None else of], 0
    while pids:
        pid = pids.pop()
        with suppress(OSError):
            fields = Path(f"/proc/{pid}/stat").read_text("utf-8").rpartition(")")[2].split()
            found += sum(map(int, fields[11:15]))
            for children in Path(f"/proc/{pid}/task").glob("*/children"):
                with suppress(OSError):
                    pids.extend(map(int, children.read_text("utf-8").split()))
    return found / TICKS_PER_S


@contextmanager
def measured(test: str) -> Iterator[None]:
    """Write the processor time of a test, its fixtures included, where the environment names a folder."""
    folder = os.environ.get(FOLDER)
    if folder is None:
        yield
        return
    before_s = used_s()
    yield
    Path(folder).mkdir(parents=True, exist_ok=True)
    with (Path(folder) / f"{os.getpid()}.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps([test, round(used_s() - before_s, 2)]) + "\n")


def by_test(folder: Path) -> Counter[str]:
    """The seconds of each test that a folder holds."""
    found = Counter[str]()
    for path in folder.glob("*.jsonl"):
        for line in path.read_text("utf-8").splitlines():
            test, seconds = json.loads(line)
            found[test] += seconds
    return found


def by_file(folder: Path) -> Counter[str]:
    """The seconds of each file of tests."""
    found = Counter[str]()
    for test, seconds in by_test(folder).items():
        found[test.partition("::")[0]] += seconds
    return found


def table(now: Counter[str], earlier: Counter[str] | None) -> str:
    """The files that take or took most, with their seconds, and the sum of all."""
    columns = [now] if earlier is None else [earlier, now]
    names = sorted(set().union(*columns), key=lambda name: -max(column[name] for column in columns))
    head = "seconds  file" if earlier is None else " before      now  file"
    rows = [(*(column[name] for column in columns), name) for name in names[:SHOWN]]
    rows.append((*(sum(column.values()) for column in columns), f"all {len(names)} files"))
    return "\n".join([head, *("  ".join(f"{cell:7.1f}" for cell in row[:-1]) + f"  {row[-1]}" for row in rows)])


if __name__ == "__main__":
    folders = [by_file(Path(name)) for name in sys.argv[1:]]
    sys.stdout.write(f"{table(folders[0], folders[1] if len(folders) > 1 else None)}\n")
