"""``basu service compare``: services with equal persons and seeds by two agents, compared in pairs."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from basu.cli.termination import terminated_as_interrupted
from basu.cli.typed_options import options_of
from basu.errors import UserError
from basu.files import write_bytes
from basu.intervals import FEW, bootstrap, sign_test
from basu.metrics.scoring import Scoring
from basu.options.run import RunOptions
from basu.outcome import Status
from basu.output.report.documents import plain
from basu.running.runner import check_parallel
from basu.settings.option import Layer
from basu_service.document import SERVICE_FILE, read_service
from basu_service.run_command import conditions_of
from basu_service.running import plan_service
from basu_service.service_batch import ServiceBatch, Side, drive_all, given_of, is_counted

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Mapping, Sequence

    from basu_service.document import ServiceDocument

FEWEST_PAIRS = 2


class Measure(NamedTuple):
    """One figure that is compared."""

    name: str
    unit: str
    value: Callable[[ServiceDocument], float | None]


def _minutes(value_s: float | None) -> float | None:
    return None if value_s is None else value_s / 60.0


def _worst(document: ServiceDocument) -> float | None:
    scores = [each["comfort_score"] for each in document["vehicles"] if each["comfort_score"] is not None]
    return min(scores, default=None)


MEASURES = (
    Measure("wait, all persons", "min", lambda one: _minutes(one["waits"]["mean_s"])),
    Measure("variation of headways", "", lambda one: one["headways"]["variation"]),
    Measure("bunched headways", "", lambda one: one["headways"]["bunched"]),
    Measure("longest gap", "min", lambda one: _minutes(one["headways"]["longest_gap_s"])),
    Measure("persons carried", "", lambda one: float(one["persons"]["carried"])),
    Measure("ride", "min", lambda one: _minutes(one["rides"]["mean_s"])),
    Measure("comfort, worst vehicle", "", _worst),
    Measure("services failed", "", lambda one: float(not one["passed"])),
)


def run(arguments: argparse.Namespace) -> int:
    """Drive what is an agent, read what is a folder, and print the comparison.

    Raises:
        UserError, AgentError: nothing can be started like this, or the services are no pairs.
        SimulatorError: the simulator failed.
    """
    if arguments.without:
        return _without(arguments)
    if len(arguments.compared) != 2 or arguments.assume is not None:
        raise UserError(
            "a comparison needs two agents or folders; with and without the shuttle is one of them with --without, and "
            "--assume goes with that"
        )
    sides = [
        None if Path(word).is_dir() else Side(letter, word)
        for letter, word in zip("ab", arguments.compared, strict=True)
    ]
    agents = [side for side in sides if side is not None]
    if agents and arguments.seeds < FEWEST_PAIRS:
        raise UserError(
            f"--seeds is {arguments.seeds}; a comparison needs at least {FEWEST_PAIRS} services of each agent"
        )
    options = options_of(RunOptions, arguments, Layer({"shuttles": arguments.shuttles}))
    parent = driven(agents, arguments, options) if agents else options.output
    folders = [
        Path(word) if side is None else parent / side.folder
        for side, word in zip(sides, arguments.compared, strict=True)
    ]
    first, second = (services_in(folder) for folder in folders)
    print(comparison([str(each) for each in arguments.compared], first, second))
    if arguments.json is not None:
        rows = {
            str(seed): {measure.name: [measure.value(first[seed]), measure.value(second[seed])] for measure in MEASURES}
            for seed in sorted(first)
        }
        write_bytes(arguments.json, (json.dumps(rows, indent=1) + "\n").encode())
    return 0


def _without(arguments: argparse.Namespace) -> int:
    """Compare with and without the shuttle, which needs the distribution for SUMO.

    Raises:
        UserError: it is not installed, or see `basu_service.without_command.run`.
    """
    if importlib.util.find_spec("basu_sumo") is None:
        raise UserError("--without plays the hours in SUMO, which is not installed; install it: pip install basu-sumo")
    from basu_service.without_command import run as run_without  # noqa: PLC0415 - a plugin of its own

    return run_without(arguments)


def driven(sides: list[Side], arguments: argparse.Namespace, options: RunOptions) -> Path:
    """Drive the services of agents, and return the folder of the comparison.

    Raises:
        UserError, AgentError, SimulatorError: see ``run``.
    """
    if options.workers > 1:
        check_parallel(options)
    conditions = conditions_of(arguments)
    given: dict[str, Any] = {"schema_version": 1}
    for side in sides:
        planned = plan_service(replace(options, agent=side.agent), conditions)
        given |= {f"{name} of {side.folder}": value for name, value in given_of(options, side.agent, planned).items()}
    folder = options.output / f"compare-{'-'.join(plain(side.agent) for side in sides)}"
    batch = ServiceBatch(folder, sides, range(options.seed, options.seed + arguments.seeds))
    with terminated_as_interrupted():
        drive_all(batch, options, conditions, Scoring(), given, resume=options.resume, say=print)
    return folder


def services_in(folder: Path) -> dict[int, ServiceDocument]:
    """Return the services of a folder by their seeds.

    Raises:
        UserError: there is none, or two have one seed.
    """
    return {document["seed"]: document for _, document in counted_services(folder)}


def counted_services(folder: Path) -> list[tuple[Path, ServiceDocument]]:
    """Return each service below a folder with its own folder.

    A service that the simulator or the user ended is left out: it says nothing of the agent.

    Raises:
        UserError: there is none, or two have one seed.
    """
    found: dict[int, tuple[Path, ServiceDocument]] = {}
    for path in sorted(folder.glob(f"*/{SERVICE_FILE}")):
        if path.parent.is_symlink():
            continue
        document = read_service(path.parent)
        if not all(is_counted(Status(each["status"])) for each in document["vehicles"]):
            continue
        if document["seed"] in found:
            raise UserError(f"{folder} has two services with the seed {document['seed']}; move one of them elsewhere")
        found[document["seed"]] = path.parent, document
    if not found:
        raise UserError(f"{folder} has no folder with {SERVICE_FILE}; name the --output of `basu service run`")
    return [found[seed] for seed in sorted(found)]


def comparison(names: list[str], first: Mapping[int, ServiceDocument], second: Mapping[int, ServiceDocument]) -> str:
    """Return the table: both means, the mean difference with its interval, and the sign test.

    Raises:
        UserError: the services are no pairs: other seeds, lengths, demands or persons.
    """
    if set(first) != set(second):
        raise UserError(f"the seeds differ ({sorted(first)} and {sorted(second)}); drive both with the same seeds")
    for seed in sorted(first):
        one, other = _conditions(first[seed]), _conditions(second[seed])
        for name, value in one.items():
            if value != other[name]:
                raise UserError(
                    f"the services with seed {seed} are no pair: {name} is {value} and {other[name]}; drive both under "
                    "the same conditions"
                )
    came = sum(each["persons"]["came"] for each in first.values())
    lines = [
        f"A {names[0]}, B {names[1]}: {len(first)} seeds, {came} persons",
        f"{'':<26}{'A':>9}{'B':>9}{'B - A':>9}  95 % interval       sign test",
    ]
    for measure in MEASURES:
        pairs = [(measure.value(first[seed]), measure.value(second[seed])) for seed in sorted(first)]
        lines.append(compared_row(_titled(measure), pairs))
    if len(first) < FEW:
        lines.append(f"only {len(first)} seeds: the intervals are too narrow")
    return "\n".join(lines)


def compared_row(title: str, pairs: Sequence[tuple[float | None, float | None]]) -> str:
    """Return a line: both means, the mean difference with its interval, and the sign test over the pairs."""
    values = np.array([[np.nan if each is None else each for each in pair] for pair in pairs], dtype=np.float64)
    known = values[np.isfinite(values).all(axis=1)]
    if len(known) < FEWEST_PAIRS:
        return f"{title:<26}  fewer than {FEWEST_PAIRS} pairs have it"
    difference, signs = bootstrap(known[:, 1] - known[:, 0]), sign_test(known[:, 0], known[:, 1])
    return (
        f"{title:<26}{known[:, 0].mean():>9.2f}{known[:, 1].mean():>9.2f}{difference.value:>9.2f}"
        f"  {f'{difference.low:.2f} to {difference.high:.2f}':<20}"
        f"A higher {signs.first_only}, B higher {signs.second_only}, p = {signs.p_value:.3f}"
    )


def _conditions(document: ServiceDocument) -> dict[str, object]:
    """Return what is equal in a pair; a drive that ended early may have made the service shorter."""
    return {
        "begins": document["begins"],
        "holding": document["holding"],
        "demand": document["demand"],
        "minutes": document["minutes"],
        "vehicles": len(document["vehicles"]),
        "persons": document["persons"]["came"],
    }


def _titled(measure: Measure) -> str:
    return f"{measure.name}, {measure.unit}" if measure.unit else measure.name
