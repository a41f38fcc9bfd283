"""``basu experiment thesis``: drives the four test runs of section 5.5 again and states the differences."""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import replace
from datetime import datetime, timezone
from typing import TYPE_CHECKING, NamedTuple

from basu.episode import Towns
from basu.errors import SimulatorError, UserError
from basu.files import find, read_json
from basu.jobs.job import versions
from basu.metrics.infraction import Infraction
from basu.metrics.score import driving_score
from basu.outcome import Fault, Status
from basu.output.report.comparison_page import compare
from basu.output.report.documents import read_run, write_json
from basu.running.batch import Batch, changes, counts
from basu.running.folder_lock import locked
from basu.running.preparation import prepare
from basu.running.run_player import OpenWorld
from basu.running.runner import runs, show
from basu.running.table_5_1 import PRINTED, ROUNDING, SCORING, in_page, measured, text
from basu.simulator import simulator_for

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from basu.options.run import RunOptions
    from basu.running.table_5_1 import Measured, Printed
    from basu.simulator import Simulator


SMALL = 0.0005  # of a score that is printed with three digits
CLOSE = 0.02  # of path following: 15 m of the short route

# why the paths' lengths are what they are, where they differ
PATHS = {
    "basic": "our driver keeps to the middle of the planned lane; where the thesis's lost 0.02 it does not say",
    "behavioral": "where the car leaves its path on purpose and what it hits was chosen here, as near to the thesis's "
    "0.56 of the route as something hard stands beside it",
    "forward": "how far a car gets that never steers is a matter of what stands straight ahead of its start; the "
    "thesis's points A and B are known from a small picture only (figure 5.2), and so is what stood there",
    "human": "another driver, and other lines through the bends",
}
STOP_SIGNS = (
    "Stop signs are in neither driving score: the thesis left them out, because CARLA's agents do not see them or "
    "never drive on. With them our scores are those of the last column."
)
NOTES = {
    "behavioral": "`deviating` drives here: `behavioral`, which leaves its path on purpose at one place, too fast, and "
    "stays where it hits something",
}


def differences(printed: Mapping[str, Printed], ours: Mapping[str, Measured], keys_by: str) -> list[str]:
    """Sentences for all agents; ``keys_by`` is the source of the keys of the human's session."""
    found = [STOP_SIGNS]
    for agent, row in ours.items():
        note = f"keys were pressed by: {keys_by}" if agent == "human" else NOTES.get(agent)
        parts = [_score(printed[agent], row), _counts(printed[agent], row), _formula(printed[agent])]
        parts += [_path(agent, printed[agent], row), note]
        found.append(f"{agent}: " + "; ".join(part for part in parts if part) + ".")
    return found


def _score(theirs: Printed, row: Measured) -> str:
    """Return the driving score beside that of the thesis, as text."""
    apart = row.driving - theirs.driving
    if abs(apart) < SMALL:
        return f"driving score {row.driving:.3f} as in the thesis"
    return f"driving score {row.driving:.3f}, {apart:+.3f} to the thesis's {theirs.driving:.3f}"


def _counts(theirs: Printed, row: Measured) -> str:
    """What was done wrong, there and here."""
    if (row.collisions, row.speeding) == (theirs.collisions, theirs.speeding):
        return "the same infractions"
    return (
        f"{_number(row.collisions, 'collision')} and {row.speeding} times too fast here, "
        f"{_number(theirs.collisions, 'collision')} and {theirs.speeding} times there"
    )


def _formula(theirs: Printed) -> str | None:
    """Whether the thesis's row follows from its own equations, and what would."""
    exact = theirs.infraction_by_formula()
    if not theirs.follows():
        factors = " x ".join(
            f"{SCORING.penalties[kind]:g}"
            for kind, number in (
                (Infraction.COLLISION_STATIC, theirs.collisions),
                (Infraction.SPEEDING, theirs.speeding),
            )
            for _ in range(number)
        )
        score = driving_score(exact, theirs.path_following, SCORING)
        return (
            f"the printed infraction score of {theirs.infraction:g} does not follow from "
            f"{_number(theirs.collisions, 'collision')} and {_number(theirs.speeding, 'speeding')}: equation 5.1 gives "
            f"{factors} = {exact:.2f}, with which the row's driving score is {score:.3f} (from {theirs.infraction:g} "
            f"the printed {theirs.driving:g} does follow)"
        )
    score = driving_score(exact, theirs.path_following, SCORING)
    if round(score, 3) != theirs.driving:
        return (
            f"the thesis rounds the infraction score {exact:.3f} to {theirs.infraction:g} before it weighs it, "
            f"which turns {score:.4f} into {theirs.driving:g}"
        )
    return None


def _path(agent: str, theirs: Printed, row: Measured) -> str | None:
    """Why the path following is another."""
    if abs(row.path_following - theirs.path_following) < ROUNDING:
        return None
    size = "nearly " if abs(row.path_following - theirs.path_following) <= CLOSE else "not "
    return f"path following {row.path_following:.3f} is {size}the thesis's {theirs.path_following:g}: {PATHS[agent]}"


def _number(count: int, what: str) -> str:
    """A count in words as far as it goes."""
    return f"{ ({0: 'no', 1: 'one'}.get(count, str(count))) } {what}{'' if count == 1 else 's'}"


EXPERIMENT_FILE = "experiment.json"
KEYS = "data/human_session.json"  # of the human; it states the source of the keys
ROUTE, VEHICLE, WEATHER = "routes/linden_short.xml", "vehicle.tesla.model3", "ClearSunset"


class ExperimentCase(NamedTuple):
    """A row of the table: its name there, and what drives here."""

    row: str
    agent: str
    keys: str | None = None


CASES = (
    ExperimentCase("basic", "basic"),
    ExperimentCase("behavioral", "deviating"),  # behavioral up to the place where it leaves the path on purpose
    ExperimentCase("forward", "forward"),
    ExperimentCase("human", "human", keys=KEYS),
)


def thesis(options: RunOptions, resumed: Path | None = None) -> int:
    """Drive all four and print our table beside table 5.1; ``options`` says where, and with which seed.

    ``resumed`` is the folder of an experiment that was broken off: the drives that are there are not driven again.

    Raises:
        UserError, AgentError: an agent cannot be driven.
        SimulatorError: the simulator failed.
    """
    began_s = time.monotonic()
    name = f"experiment-thesis-{datetime.now(timezone.utc).astimezone():%Y-%m-%dT%H-%M-%S}"
    folder = options.output / name if resumed is None else resumed
    with locked(folder):
        _begin(folder, options, resume=resumed is not None)
        folders = _drive_all(replace(options, output=folder))
        ours = {case.row: _row(folders[case.row]) for case in CASES}
        explained, written = _compared(folder, folders, ours)
    print(f"\n{text(PRINTED, ours)}\n")
    print("\n".join(f"- {sentence}" for sentence in explained))
    print(f"\n{written}")
    print(f"wall time         {time.monotonic() - began_s:.0f} s")
    return 0


def _begin(folder: Path, options: RunOptions, *, resume: bool) -> None:
    """Write what the experiment depends on, or compare it with that of one that goes on.

    Raises:
        UserError: there is no experiment to go on with, or it was begun differently.
    """
    path = folder / EXPERIMENT_FILE
    now = {"--seed": options.seed, "the simulator": "our own" if options.host is None else "at --host", **versions()}
    if not resume:
        write_json(path, now)
        return
    if not path.exists():
        raise UserError(f"{folder} is no folder of an experiment that can go on; leave out --resume to begin another")
    changed = changes(read_json(path, "the experiment's document"), now)
    if changed:
        raise UserError(f"the experiment in {folder} was begun differently: {changed}; begin another without --resume")


def _drive_all(options: RunOptions) -> dict[str, Path]:
    """Drive the runs that are not there yet, in one simulator; return the folder of each by row.

    Raises:
        UserError, AgentError, SimulatorError, KeyboardInterrupt: a drive is none that can be compared.
    """
    batch = Batch(options.output, dict(enumerate(case.row for case in CASES)))
    batch.clear()
    folders = {}
    for number, result in list(batch.finished()):
        if counts(result):
            folders[batch.name(number)] = options.output / batch.name(number)
        else:
            batch.set_aside(number, result)
    left = [(number, case) for number, case in enumerate(CASES, start=1) if case.row not in folders]
    if left:
        with simulator_for(options.simulator) as simulator:
            towns = Towns(simulator)
            for number, case in left:
                print(f"\n{number} of {len(CASES)}: {case.row} ({case.agent})")
                folders[case.row] = _drive(case, options, simulator, towns)
                _row(folders[case.row])  # a drive that cannot be compared ends the experiment
    return folders


def _compared(folder: Path, folders: Mapping[str, Path], ours: Mapping[str, Measured]) -> tuple[list[str], str]:
    """Write the comparison; return the sentences about differences, and the line that names the page."""
    explained = differences(PRINTED, ours, read_json(find(KEYS, "session of keys"), "the session of keys")["by"])
    return explained, str(compare([folders[case.row] for case in CASES], folder, in_page(PRINTED, ours, explained)))


def _drive(case: ExperimentCase, options: RunOptions, simulator: Simulator, towns: Towns) -> Path:
    """Drive one of the four runs in the simulator of all, and return its folder."""
    wanted = replace(options, agent=case.agent, keys=case.keys, routes=ROUTE, vehicle=VEHICLE, weather=WEATHER)
    plan = prepare(wanted)
    batch = Batch(options.output, {0: case.row})
    (done,) = runs(wanted, SCORING, OpenWorld(plan, simulator, towns), plan.jobs, batch)
    show(done, wanted)
    assert done.folder is not None, "a drive in this process that cannot begin raises its error"
    return done.folder


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
