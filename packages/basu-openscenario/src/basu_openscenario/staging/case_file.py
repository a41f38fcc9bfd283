"""The reader of OpenSCENARIO files for the library of cases: one class and one case a file."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from basu.scenarios.cases import ScenarioFile as CaseFile
from basu.scenarios.stage import Pose
from basu.scenarios.xml_elements import Case, GivenActor
from basu_openscenario.reading.scenario_file import read_scenario
from basu_openscenario.staging.open_scenario import OpenScenario, ego_of, parameters_of
from basu_openscenario.staging.refusals import check_staged

if TYPE_CHECKING:
    from pathlib import Path


def read_case_file(path: Path) -> CaseFile:
    """Return the class and the case of a file.

    Raises:
        ScenarioError: the file is broken, or asks for what is not supported.
    """
    path = path.resolve()
    scenario = read_scenario(path)
    check_staged(scenario)
    assert scenario.road_file is not None, "a file without a road network was refused"
    words = re.findall(r"[A-Za-z0-9]+", path.stem)
    name = "".join(word[:1].upper() + word[1:] for word in words) + "Xosc"
    members = {
        "__doc__": scenario.description or f"The OpenSCENARIO file {path.name}.",
        "file": path,
        "defaults": {one: declared.value for one, declared in scenario.declarations.items()},
        "parameters": parameters_of(scenario, ego_of(scenario)),
    }
    case = Case(
        name=re.sub(r"[^A-Za-z0-9_.-]", "_", path.stem),
        type=name,
        town=scenario.road_file.stem,
        ego=GivenActor(role="hero", model="vehicle.*", pose=Pose(0.0, 0.0)),
        map_file=scenario.road_file,
        source=str(path),
    )
    return CaseFile([type(name, (OpenScenario,), members)], (case,))
