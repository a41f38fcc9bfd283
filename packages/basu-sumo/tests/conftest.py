"""A small SUMO network with its configurations; one SUMO a test."""

import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

sumo = pytest.importorskip("sumo", reason="the extra for SUMO is not installed")

NODES = """<nodes><node id="a" x="0" y="0"/><node id="b" x="200" y="0"/><node id="c" x="400" y="0"/>
<node id="d" x="200" y="200"/></nodes>"""
EDGES = "".join(
    f'<edge id="{start}{end}" from="{start}" to="{end}" numLanes="1" speed="11"/>'
    for start, end in ("ab", "ba", "bc", "cb", "bd", "db")
)
TYPES = """<additional><vType id="vehicle.audi.a2" vClass="passenger" length="3.7"/>
<vTypeDistribution id="traffic" vTypes="vehicle.audi.a2" probabilities="1"/></additional>"""
ROUTES = """<routes><vehicle id="one" type="vehicle.audi.a2" depart="0"><route edges="ab bc"/></vehicle></routes>"""
CONFIG = """<configuration><input><net-file value="small.net.xml"/><additional-files value="types.add.xml"/>
{routes}</input></configuration>"""


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three streets that meet at b, one vehicle from a to c; a configuration with it and one without."""
    place = tmp_path_factory.mktemp("small")
    (place / "n.nod.xml").write_text(NODES)
    (place / "e.edg.xml").write_text(f"<edges>{EDGES}</edges>")
    netconvert = Path(sumo.SUMO_HOME) / "bin" / "netconvert"
    command = [str(netconvert), "-n", "n.nod.xml", "-e", "e.edg.xml", "-o", "small.net.xml"]
    subprocess.run(command, cwd=place, check=True, capture_output=True)
    (place / "types.add.xml").write_text(TYPES)
    (place / "small.rou.xml").write_text(ROUTES)
    (place / "small.sumocfg").write_text(CONFIG.format(routes='<route-files value="small.rou.xml"/>'))
    (place / "small.empty.sumocfg").write_text(CONFIG.format(routes=""))
    return place


PLAIN = ("--offset.disable-normalization", "true")
STREET_NODES = """<nodes><node id="a" x="0" y="4000"/><node id="b" x="200" y="4000"/><node id="c" x="400" y="4000"/>
</nodes>"""  # north of Linden, where nothing stands
STREET_EDGES = (
    '<edges><edge id="ab" from="a" to="b" sidewalkWidth="2"/><edge id="bc" from="b" to="c" sidewalkWidth="2"/></edges>'
)
STOPS = """<additional><busStop id="S1" lane="ab_1" startPos="90" endPos="102"/>
<busStop id="S2" lane="bc_1" startPos="90" endPos="102"/></additional>"""
PEOPLE = """<routes>
<person id="early" depart="0"><stop busStop="S1" duration="0.1"/><ride busStop="S2" lines="shuttle"/><walk to="bc"/>
</person>
<person id="second" depart="0"><stop busStop="S1" duration="0.1"/><ride busStop="S2" lines="shuttle"/></person>
<person id="tram" depart="0"><stop busStop="S1" duration="0.1"/><ride busStop="S2" lines="tram"/></person>
<person id="walker" depart="0" departPos="80"><walk from="ab" busStop="S1"/><ride busStop="S2" lines="shuttle"/>
</person>
</routes>"""
STREET_CONFIG = """<configuration><input><net-file value="walk.net.xml"/><additional-files value="stops.add.xml"/>
<route-files value="people.rou.xml"/></input></configuration>"""


@pytest.fixture(scope="session")
def walked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A street with a pavement and two stops, and four persons at the first of them or on their way to it."""
    place = tmp_path_factory.mktemp("walked")
    (place / "n.nod.xml").write_text(STREET_NODES)
    (place / "e.edg.xml").write_text(STREET_EDGES)
    netconvert = Path(sumo.SUMO_HOME) / "bin" / "netconvert"
    command = [str(netconvert), "-n", "n.nod.xml", "-e", "e.edg.xml", "--walkingareas", *PLAIN, "-o", "walk.net.xml"]
    subprocess.run(command, cwd=place, check=True, capture_output=True)
    for name, text in (("stops.add.xml", STOPS), ("people.rou.xml", PEOPLE), ("walk.sumocfg", STREET_CONFIG)):
        (place / name).write_text(text)
    return place


@pytest.fixture(autouse=True)
def _one_sumo_a_test() -> Iterator[None]:
    """End the SUMO of a test that failed: a process holds one."""
    yield
    libsumo = pytest.importorskip("libsumo")
    if libsumo.simulation.isLoaded():
        libsumo.close()
