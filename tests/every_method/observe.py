"""Calls the members of some tables and says what came of each: ``python -m every_method.observe "TABLES" PORT TAPS``.

A process of its own, because some calls can end the client's process: it prints a line before and after each member, so
that whoever started it knows which member was the last, and can begin again after it.
"""

import importlib
import json
import os
import re
import sys
from collections.abc import Mapping

from every_method.call import Call, Defect
from every_method.outcome import Kind, Outcome
from every_method.stage import Stage
from every_method.wiretap import wiretap

PROCESSES = (
    "enums geometry vehicle_values settings map world lights actors walkers vehicles commands traffic_manager",
    "sensors cameras",
    "client",
)
"""The tables by name, as they share a process and an episode: whose events must not outlive theirs stay apart."""


def observe(stage: Stage, call: Call) -> Outcome:
    """Make a call and say what came of it."""
    expected, run = (call, call.call) if isinstance(call, Defect) else (None, call)
    error: Exception | None = None
    answer: object = None
    begin = stage.barrier()
    try:
        answer = run(stage)
    except Exception as raised:  # noqa: BLE001 - whatever the client raises is what is being looked at
        error = raised
    end = stage.barrier()
    if expected is not None:
        return _defect(expected, error)
    return _outcome(stage, begin, end, answer, error)


def _defect(expected: Defect, error: Exception | None) -> Outcome:
    """Say whether the client fails as it is known to: a defect that has gone belongs into the table no longer."""
    if expected.raises not in {kind.__name__ for kind in type(error).__mro__}:
        return Outcome(Kind.WRONG, (), f"{type(error).__name__} ({error}) instead of {expected.raises}")
    told = (str(error).splitlines() or [""])[0].strip()
    return Outcome(Kind.DEFECT, (), f"{type(error).__name__}: {told}; {expected.because}")


def _masked(sentence: str) -> str:
    """Return a sentence without the numbers that actors and streams happen to have."""
    return re.sub(r"\b(vehicle|actor|stream|sensor|Id:) \d+", r"\1 …", sentence)


def _outcome(stage: Stage, begin: int, end: int, answer: object, error: Exception | None) -> Outcome:
    calls, refusals = stage.recorded(begin, end)
    functions = tuple(sorted({call.function for call in calls}))
    if error is not None:
        told = [(call, text) for call, text in stage.tap.refusals(begin, end) if text in str(error)]
        if told:
            return Outcome(Kind.REFUSED, tuple(sorted({call.function for call, _ in told})), _masked(told[0][1]))
        return Outcome(Kind.WRONG, functions, f"{type(error).__name__}: {error}")
    if answer is not None and answer is not True:
        return Outcome(Kind.WRONG, functions, f"returned {answer!r}, which is not plausible")
    if refusals:
        return Outcome(Kind.LOGGED, functions, _masked(refusals[0][1]))
    return Outcome(Kind.WORKS if functions else Kind.CLIENT, functions)


def rows(tables: str) -> dict[str, Call]:
    """Return the rows of some tables, in the order in which they are called."""
    found: dict[str, Call] = {}
    for name in tables.split():
        added: Mapping[str, Call] = importlib.import_module(f"every_method.calls.{name}").CALLS
        assert not found.keys() & added.keys(), f"in two tables: {found.keys() & added.keys()}"
        found |= added
    return found


def main() -> None:
    """Observe some tables, or what of them begins with a member."""
    tables, port, taps, *first = sys.argv[1:]
    calls = list(rows(tables).items())
    begin = next((at for at, (member, _) in enumerate(calls) if first == [member]), 0)
    stage = Stage(wiretap(taps, int(port)))
    for member, call in calls[begin:]:
        sys.stdout.write(json.dumps([member]) + "\n")
        sys.stdout.flush()
        kind, functions, sentence = observe(stage, call)
        sys.stdout.write(json.dumps([member, kind.value, functions, sentence]) + "\n")
        sys.stdout.flush()
    os._exit(0)  # the client's own threads may end a process that takes its leave in order


if __name__ == "__main__":
    main()
