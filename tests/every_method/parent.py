"""Observes all tables against a server, in processes of their own, and survives the end of any of them."""

import json
import os
import subprocess
import sys
from pathlib import Path

from every_method.observe import PROCESSES, rows
from every_method.outcome import Kind, Outcome
from every_method.wiretap import wiretaps

PROCESS_LIMIT_S = 240.0


def observe_all(port: int, processes: tuple[str, ...] = PROCESSES) -> dict[str, Outcome]:
    """Return what came of every member of the tables.

    Races inside the client end its process now and then, while it connects too, so a member is called again; one that
    ends two processes is WRONG, and the next ones go on.
    """
    outcomes: dict[str, Outcome] = {}
    with wiretaps() as taps:
        for tables in processes:
            members = list(rows(tables))
            begin, ended_at = 0, -1
            while begin < len(members):
                ended = _run([tables, str(port), taps, members[begin]], outcomes)
                if ended is None:
                    break
                member, how = ended
                begin = members.index(member)
                if begin == ended_at:
                    outcomes[member] = Outcome(Kind.WRONG, (), f"the client's process {how}")
                    begin += 1
                ended_at = begin
    return outcomes


def _run(arguments: list[str], outcomes: dict[str, Outcome]) -> tuple[str, str] | None:
    """Run one process and take what it says; return the member at which it ended, and how, or None at the end."""
    folder = str(Path(__file__).parents[1])
    command = [sys.executable, "-m", "every_method.observe", *arguments]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([folder, os.environ.get("PYTHONPATH", "")])}
    try:
        ran = subprocess.run(
            command, capture_output=True, text=True, timeout=PROCESS_LIMIT_S, env=environment, check=False
        )
        said, how = ran.stdout, f"ended with {ran.returncode}: {ran.stderr.strip()[-500:]}"
    except subprocess.TimeoutExpired as expired:
        said, how = (expired.stdout or b"").decode(), f"did not go on for {PROCESS_LIMIT_S:g} s"
    lines = [json.loads(line) for line in said.splitlines() if line.startswith('["')]
    for member, kind, functions, sentence in (line for line in lines if len(line) > 1):
        outcomes[member] = Outcome(Kind(kind), tuple(functions), sentence)
    if lines and len(lines[-1]) == 1:
        return lines[-1][0], how
    if not lines and how.startswith("ended with -"):  # the client ended it while it connected
        return arguments[-1], how
    if not how.startswith("ended with 0"):
        raise AssertionError(f"tables {arguments[0]}: the process {how}")
    return None
