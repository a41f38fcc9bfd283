"""A case of BASU as an OpenSCENARIO file with its road beside it."""

from __future__ import annotations

import datetime as dt
from typing import TYPE_CHECKING, NamedTuple
from xml.etree.ElementTree import tostring

import carla
from lxml import etree
from scenariogeneration import xosc

from basu.errors import ScenarioError
from basu.files import write_bytes
from basu.running.scenario_runs.options import PLAYERS
from basu.scenarios.stage import EGO
from basu.testing import careful, rehearse
from basu_openscenario.exporting import scenario_runner
from basu_openscenario.exporting.bodies import entity_of
from basu_openscenario.exporting.conditions import RehearsedCase
from basu_openscenario.exporting.contacts import passed_through
from basu_openscenario.exporting.motions import motions_of
from basu_openscenario.exporting.ordered_acts import OrderedActsWriter
from basu_openscenario.exporting.phases import phases_of
from basu_openscenario.exporting.storyboard import StoryboardWriter

if TYPE_CHECKING:
    from pathlib import Path

    from basu.scenarios.playable import Playable
    from basu.scenarios.scenario import Scenario
    from basu.testing import Rehearsal

MINOR_VERSION = 2
"""Of OpenSCENARIO XML 1: the first with variables, and the last that esmini 3.6 reads in full."""
ESMINI, SCENARIO_RUNNER = PLAYERS
EGO_MPS = 6.0
"""The speed of the ego in the file, which brakes for what is in its lane; the shuttle's agents drive as fast."""
STEP_S = 0.01
"""Of the rehearsal: triggers come true in the same step as in players with steps of 10 ms."""
AUTHOR = "BASU"
LIGHT_TYPES = "1000"
"""The types of OpenDRIVE's own signals begin so."""
DATE = dt.datetime(2026, 1, 1, tzinfo=dt.timezone.utc).replace(tzinfo=None)
"""Of all files, so that the same case gives the same bytes."""


class Exported(NamedTuple):
    """A case as a scenario of OpenSCENARIO, and what the file must play."""

    scenario: xosc.Scenario
    played: Rehearsal
    """The rehearsal that it was made of."""
    begins_s: dict[str, float]
    """When each event of a motion begins in it, in s, by the event's name."""


def export_case(playable: Playable, scenario: Scenario, opendrive: str, path: Path, player: str = ESMINI) -> Exported:
    """Write a case to ``path``, and beside it what its player needs; return what was written.

    That is the road as TOWN.xodr for esmini, and a controller for ScenarioRunner, which takes the road from the server.

    Args:
        playable: the case.
        scenario: the case on its route.
        opendrive: the text of its road network.
        path: of the file, FILE.xosc.
        player: one of ``PLAYERS``.

    Raises:
        ScenarioError: the case does what the player cannot express.
    """
    road = path.with_name(f"{playable.case.town}.xodr")
    exported = exported_case(playable, scenario, road.name, player)
    document = exported.scenario.get_element()
    if player == SCENARIO_RUNNER:
        blueprints = {EGO: playable.case.ego.model, **{one.name: one.blueprint for one in playable.cast(scenario)}}
        passed = passed_through(exported.played, blueprints)
        scenario_runner.adapt(document, carla.Map(playable.case.town, opendrive), passed)
    path.parent.mkdir(parents=True, exist_ok=True)
    if player == SCENARIO_RUNNER:
        scenario_runner.write_controller(path.parent)
    else:
        write_bytes(road, _with_lights(opendrive))
    write_bytes(path, tostring(document, "utf-8", xml_declaration=True))
    return exported


def exported_case(playable: Playable, scenario: Scenario, road: str, player: str = ESMINI) -> Exported:
    """Return a case as a scenario of OpenSCENARIO on the road network in the file ``road``.

    Raises:
        ScenarioError: it does what the player cannot express.
    """
    specs = {spec.name: spec for spec in playable.cast(scenario)}
    played = rehearse(scenario, careful(EGO_MPS), step_s=STEP_S)
    phases = phases_of(played)
    motions = [motions_of(played, phases.parts, name) for name in (EGO, *specs)]
    entities = xosc.Entities()
    entities.add_scenario_object(EGO, entity_of(playable.case.ego.model, by_agent=True))
    for name, spec in specs.items():
        entities.add_scenario_object(name, entity_of(spec.blueprint, by_agent=False))
    places = {EGO: scenario.place.at(-scenario.place.trigger_s_m), **{name: one.pose for name, one in specs.items()}}
    make_writer = OrderedActsWriter if player == SCENARIO_RUNNER else StoryboardWriter
    writer = make_writer(RehearsedCase(scenario.place.route, played, STEP_S), phases)
    try:
        storyboard = xosc.StoryBoard(writer.init(motions, places), writer.stop(scenario.timeout_s))
        for act in writer.acts(motions):
            storyboard.add_act(act)
    except ScenarioError as error:
        raise ScenarioError(f"{playable.case.name} cannot be exported: {error}") from None
    variables = xosc.VariableDeclarations()
    for variable in writer.variables():
        variables.add_variable(variable)
    written = xosc.Scenario(
        f"{playable.case.name}: {scenario.title()}",
        AUTHOR,
        xosc.ParameterDeclarations(),
        entities,
        storyboard,
        xosc.RoadNetwork(road),
        xosc.Catalog(),
        osc_minor_version=MINOR_VERSION,
        creation_date=DATE,
        variable_declaration=variables,
    )
    return Exported(written, played, dict(writer.begins_s))


def _with_lights(opendrive: str) -> bytes:
    """Return a road network with lights of the country of their types, and without a value, as esmini asks.

    Types from 1000001 on are OpenDRIVE's own. A value says nothing of a light, and CARLA does not look at the country.
    """
    root = etree.fromstring(opendrive.encode())
    for signal in root.iter("signal"):
        if signal.get("dynamic") == "yes" and (signal.get("type") or "").startswith(LIGHT_TYPES):
            signal.set("country", "OpenDRIVE")
            signal.attrib.pop("value", "")
    return etree.tostring(root, xml_declaration=True, encoding="UTF-8")
