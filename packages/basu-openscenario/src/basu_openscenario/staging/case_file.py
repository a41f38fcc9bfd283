"""The reader of OpenSCENARIO files for the library of cases: a class a file, and a case, or one for each run."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from basu.errors import ScenarioError
from basu.scenarios.cases import ScenarioFile as CaseFile
from basu.scenarios.parameters import Choice
from basu.scenarios.stage import Pose
from basu.scenarios.xml_elements import Case, GivenActor
from basu_openscenario.reading.distributions import read_distribution
from basu_openscenario.reading.parameters import within_constraints
from basu_openscenario.reading.scenario_file import read_scenario
from basu_openscenario.reading.xml_node import read_xml
from basu_openscenario.staging.open_scenario import OpenScenario, ego_of, parameters_of
from basu_openscenario.staging.refusals import check_staged

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from basu.scenarios.parameters import Parameter
    from basu_openscenario.reading.distributions import Assignment
    from basu_openscenario.reading.scenario_file import ScenarioFile


def read_case_file(path: Path) -> CaseFile:
    """Return the class and the case of a file; a file with a distribution of parameters has a case for each run.

    Raises:
        ScenarioError: the file is broken, or asks for what is not supported.
    """
    path = path.resolve()
    distribution = read_distribution(path)
    file = path if distribution is None else distribution.scenario
    runs: Sequence[Assignment] = ({},) if distribution is None else distribution.runs
    scenario = read_scenario(file)
    _check_runs(runs, scenario, path)
    runs, left_out = _allowed(runs, file, path)
    check_staged(scenario)
    assert scenario.road_file is not None, "a file without a road network was refused"
    words = re.findall(r"[A-Za-z0-9]+", path.stem)
    name = "".join(word[:1].upper() + word[1:] for word in words) + "Xosc"
    members = {
        "__doc__": (scenario.description or f"The OpenSCENARIO file {path.name}.") + left_out,
        "file": file,
        "defaults": {one: declared.value for one, declared in scenario.declarations.items()},
        "parameters": (*parameters_of(scenario, ego_of(scenario)), *_words(runs, scenario)),
    }
    case = Case(
        name=re.sub(r"[^A-Za-z0-9_.-]", "_", path.stem),
        type=name,
        town=scenario.road_file.stem,
        ego=GivenActor(role="hero", model="vehicle.*", pose=Pose(0.0, 0.0)),
        map_file=scenario.road_file,
        source=str(path),
    )
    if distribution is None:
        cases: tuple[Case, ...] = (case,)
    else:
        digits = len(str(len(runs)))
        cases = tuple(
            replace(case, name=f"{case.name}-{nth:0{digits}}", values=values) for nth, values in enumerate(runs, 1)
        )
    return CaseFile([type(name, (OpenScenario,), members)], cases)


def _check_runs(runs: Sequence[Assignment], scenario: ScenarioFile, path: Path) -> None:
    """Refuse parameters that the scenario does not declare.

    Raises:
        ScenarioError: there is one.
    """
    for name in dict.fromkeys(name for values in runs for name in values):
        if name not in scenario.declarations:
            there = ", ".join(scenario.declarations) or "none"
            raise ScenarioError(f"{path}: {scenario.path} declares no parameter '{name}'; it declares {there}")


def _allowed(runs: Sequence[Assignment], file: Path, path: Path) -> tuple[Sequence[Assignment], str]:
    """Return the runs that the constraints of the scenario allow, and a sentence about the others.

    Raises:
        ScenarioError: they allow none.
    """
    allowed = within_constraints(read_xml(file, "OpenSCENARIO"), runs)
    if not allowed:
        raise ScenarioError(f"{path}: the constraints of {file} allow none of the {len(runs)} runs; correct the values")
    count = len(runs) - len(allowed)
    left_out = f" {count} of {len(runs)} runs are left out: their values are outside the constraints of the scenario."
    return [dict(run) for run in allowed], left_out if count else ""


def _words(runs: Sequence[Assignment], scenario: ScenarioFile) -> list[Parameter]:
    """Return the parameters that are words and have values in a distribution; others are not parameters of a case."""
    found: list[Parameter] = []
    for name, declared in scenario.declarations.items():
        values = dict.fromkeys(values[name] for values in runs if name in values)
        if values and declared.kind in {"string", "dateTime"}:
            found.append(Choice(name, tuple(dict.fromkeys((declared.value, *values))), "a parameter of the file"))
    return found
