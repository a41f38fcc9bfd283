"""``basu experiment thesis``: the four test runs of section 5.5, driven again."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import replace
from datetime import datetime, timezone
from typing import TYPE_CHECKING, NamedTuple

from basu.agents.manual.session import read_session
from basu.errors import SimulatorError, UserError
from basu.metrics.infraction import Infraction
from basu.outcome import Fault, Status
from basu.output.report.compare.writing import compare
from basu.output.report.folder import LATEST
from basu.output.report.reading import read_run
from basu.running.experiment.differences import differences
from basu.running.experiment.table_5_1 import PRINTED, SCORING, measured
from basu.running.experiment.tables import in_page, text
from basu.running.runner import run
from basu.utils.packaged import find

if TYPE_CHECKING:
    from pathlib import Path

    from basu.options import RunOptions
    from basu.running.experiment.table_5_1 import Measured

KEYS = "data/human_session.json"  # of the human; it knows who pressed them
ROUTE, VEHICLE, WEATHER = "routes/linden_short.xml", "vehicle.tesla.model3", "ClearSunset"


class Case(NamedTuple):
    """A row of the table: its name there, and what drives here."""

    row: str
    agent: str
    keys: str | None = None


CASES = (
    Case("basic", "basic"),
    Case("behavioral", "deviating"),  # behavioral up to the place where it leaves the path on purpose
    Case("forward", "forward"),
    Case("human", "human", keys=KEYS),
)


def thesis(options: RunOptions) -> int:
    """Drive all four and print our table beside table 5.1; ``options`` says where, and with which seed.

    Raises:
        UserError, AgentError: an agent cannot be driven.
        SimulatorError: the simulator failed.
    """
    began_s = time.monotonic()
    folder = options.output / f"experiment-thesis-{datetime.now(timezone.utc).astimezone():%Y-%m-%dT%H-%M-%S}"
    try:
        folder.mkdir(parents=True)
    except OSError as error:
        raise UserError(f"{folder} could not be made: {error.strerror}; name another place with --output") from error
    ours: dict[str, Measured] = {}
    folders = []
    for number, case in enumerate(CASES, start=1):
        print(f"\n{number} of {len(CASES)}: {case.row} ({case.agent})")
        folders.append(_drive(case, replace(options, output=folder)))
        ours[case.row] = _row(folders[-1])
    by = read_session(find(KEYS, "session of keys")).by
    explained = differences(PRINTED, ours, by)
    written = compare(folders, folder, in_page(PRINTED, ours, explained))
    print(f"\n{text(PRINTED, ours)}\n")
    print("\n".join(f"- {sentence}" for sentence in explained))
    print(f"\n{written}")
    print(f"wall time         {time.monotonic() - began_s:.0f} s")
    return 0


def _drive(case: Case, options: RunOptions) -> Path:
    """Drive one of them; the folder it left."""
    wanted = replace(options, agent=case.agent, keys=case.keys, routes=ROUTE, vehicle=VEHICLE, weather=WEATHER)
    run(wanted, SCORING)
    return (options.output / LATEST).resolve()


def _row(folder: Path) -> Measured:
    """Our row of the table.

    Raises:
        UserError, SimulatorError, KeyboardInterrupt: the drive is none that can be compared.
    """
    result = read_run(folder).result
    status = result.outcome.status
    if status is Status.INTERRUPTED:
        raise KeyboardInterrupt
    if result.scores is None or status.fault in {Fault.SETUP, Fault.SIMULATOR}:
        kind = UserError if status.fault is Fault.SETUP else SimulatorError
        raise kind(
            f"the experiment ends here, {folder.name} is not to be compared: {status.value}, {result.outcome.message}"
        )
    counts = Counter(Infraction(found.kind.value) for found in result.infractions)
    return measured(counts, result.scores.path_following)
