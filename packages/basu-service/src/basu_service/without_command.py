"""``basu service compare AGENT --without``: the hours of driven services with the shuttle and without it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from basu.cli.typed_options import options_of
from basu.errors import UserError
from basu.files import find, write_bytes
from basu.intervals import FEW
from basu.jobs.job import Job, Lost
from basu.jobs.playing import play_jobs
from basu.options.run import RunOptions
from basu.output.progress import drives_bar
from basu.output.report.documents import plain
from basu.settings.option import Layer
from basu_service.assumptions import packaged_assumptions, read_assumptions
from basu_service.compare_command import FEWEST_PAIRS, compared_row, counted_services, driven
from basu_service.impact import WITH, WITHOUT, ImpactJob, impact_player
from basu_service.service_batch import Side

if TYPE_CHECKING:
    import argparse
    from collections.abc import Mapping

COUNTED = ("came", "warm_up", "open", "walked", "drove")
OF_TRAFFIC = (("km", "km"), ("fuel_kg", "fuel, kg"), ("co2_kg", "CO2, kg"), ("nox_g", "NOx, g"), ("pm_g", "PM, g"))


def run(arguments: argparse.Namespace) -> int:
    """Drive the services if an agent is named, let SUMO play each one twice, and print the comparison.

    Raises:
        UserError, AgentError: nothing can be played like this.
        SimulatorError: the simulator failed.
    """
    if len(arguments.compared) != 1:
        raise UserError("--without compares one agent or one folder of services; name one")
    word = arguments.compared[0]
    path = packaged_assumptions() if arguments.assume is None else find(arguments.assume, "file of assumptions", None)
    assumed = read_assumptions(path)
    options = options_of(RunOptions, arguments, Layer({"shuttles": arguments.shuttles}))
    folder = Path(word)
    if not folder.is_dir():
        if arguments.seeds < FEWEST_PAIRS:
            raise UserError(f"--seeds is {arguments.seeds}; a comparison needs at least {FEWEST_PAIRS} services")
        side = Side("a", word)
        folder = driven([side], arguments, options) / side.folder
    paths = {document["seed"]: path for path, document in counted_services(folder)}
    output = options.output / f"without-{plain(str(folder.resolve().relative_to(folder.resolve().anchor)))}"
    jobs = [Job(seed, ImpactJob(paths[seed], output / f"seed-{seed:04d}")) for seed in sorted(paths)]
    impacts: dict[int, dict[str, Any]] = {}
    with drives_bar(len(jobs), " services") as bar:
        for answer in play_jobs(impact_player(assumed), jobs, options.workers):
            bar.update()
            value = answer.sentence if isinstance(answer, Lost) else answer.value
            if isinstance(value, str):
                raise UserError(f"the service {paths[answer.number]} could not be played: {value}")
            impacts[answer.number] = value
    print(impact_table(word, impacts))
    print(f"{'plays':<26}{output}")
    if arguments.json is not None:
        rows = {str(seed): impacts[seed] for seed in sorted(impacts)}
        write_bytes(arguments.json, (json.dumps(rows, indent=1) + "\n").encode())
    return 0


def impact_table(name: str, impacts: Mapping[int, Mapping[str, Any]]) -> str:
    """Return the comparison as text: A with the shuttle, B without it."""
    rows = [impacts[seed] for seed in sorted(impacts)]
    sums = {each: sum(row["persons"][each] for row in rows) for each in COUNTED}
    counted = (
        f"{sums['came']} persons came: {sums['warm_up']} set out in the warm-up, {sums['open']} were under way at the "
        f"end; without the shuttle {sums['walked']} walk and {sums['drove']} drive"
    )
    lines = [
        f"A with the shuttle ({name}), B without it: {len(rows)} seeds, SUMO plays both",
        counted,
        f"{'':<26}{'A':>9}{'B':>9}{'B - A':>9}  95 % interval       sign test",
    ]
    doors = (
        ("door to door, min", "door_to_door_s"),
        ("of walkers, min", "door_to_door_of_walkers_s"),
        ("of drivers, min", "door_to_door_of_drivers_s"),
    )
    for title, key in doors:
        lines.append(compared_row(title, [_pair(row[key], 60.0) for row in rows]))
    lines.append(compared_row("delay of a trip, s", [_pair(row["others"]["delay_s"], 1.0) for row in rows]))
    for key, title in OF_TRAFFIC:
        pairs = [(row["others"][WITH][key], row["others"][WITHOUT][key] + row["cars_of_persons"][key]) for row in rows]
        lines.append(compared_row(f"cars, {title}", pairs))
    lines.append(compared_row("shuttles, km", [(row["shuttle"]["km"], 0.0) for row in rows]))
    lines.append(compared_row("shuttles, kWh", [(row["shuttle"]["kwh"], 0.0) for row in rows]))
    usd, miles = (sum(row["shuttle"][key] for row in rows) for key in ("usd", "passenger_miles"))
    cost = f"{usd / miles:.2f} USD" if miles else "no passenger was carried"
    lines.append(f"{'cost of a passenger-mile':<26}{cost} ({usd:.0f} USD for {miles:.1f} miles, by the assumptions)")
    if len(rows) < FEW:
        lines.append(f"only {len(rows)} seeds: the intervals are too narrow")
    return "\n".join(lines)


def _pair(values: list[float] | None, unit: float) -> tuple[float | None, float | None]:
    return (None, None) if values is None or None in values else (values[0] / unit, values[1] / unit)
