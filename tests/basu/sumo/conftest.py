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


@pytest.fixture(autouse=True)
def _one_sumo_a_test() -> Iterator[None]:
    """End the SUMO of a test that failed: a process holds one."""
    yield
    libsumo = pytest.importorskip("libsumo")
    if libsumo.simulation.isLoaded():
        libsumo.close()
