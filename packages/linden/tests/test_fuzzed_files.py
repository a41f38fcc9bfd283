"""Claims about damaged and hostile files: maps and recordings are used, or refused by a sentence, and never a bug.

A seeded mutator of its own: so many examples, always the same, whatever the clock says.
"""

import contextlib
import random
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings
from lxml import etree

from fakes import recordings as made
from linden.errors import UserError
from linden.maps.facts import derive
from linden.maps.library import GENERATED_MAP, LoadedMap, Walls
from linden.maps.navigation.areas import surfaces_of
from linden.maps.navigation.build import build
from linden.maps.navigation.detour import Obstacles
from linden.maps.opendrive.parse import parse
from linden.maps.road_walls import walls_along
from linden.protocol.values.episode import EpisodeSettings
from linden.protocol.values.space import Transform
from linden.replay.file.contents_report import file_info
from linden.replay.file.packets import RecordingError
from linden.replay.file.read import Recording
from linden.replay.file.reports import blocked, collisions
from linden.replay.file.track import track_of
from linden.replay.replayer import ReplayPlan
from linden.scenery.map_mesh import standing
from linden.simulation.surroundings import scenery_of
from linden.world import World
from opendrive_texts import SIGNS_AND_LIGHTS as STREET

SEED = 20_261_122
TIMES = max(1, settings().max_examples // 100)
"""1; the profile ``explore`` has ten times as many examples."""
MAPS, SEEN, RECORDINGS = 250 * TIMES, 10, 300 * TIMES
"""Examples; every ``SEEN``-th map is built as cameras see it and walkers walk on it, which takes longer."""

NUMBERS = [
    *("0", "-0", "1", "-1", "0.5", "3", "-3", "90", "1e3", "-1e3", "1e5", "-1e5", "1e7", "1e9", "-1e9", "1e10"),
    *("1e-5", "1e-7", "1e-12", "1e-300", "-1e-300", "1e308", "-1e308", "1e400", "nan", "inf", "-inf", ""),
    *("2147483647", "-2147483648", "4294967296", "1_0", "x", "0x10", " 7 ", "driving", "sidewalk", "crosswalk"),
]


def changed_map(chance: random.Random) -> str:
    """The street with a few of its elements and attributes changed, taken out, repeated or put elsewhere."""
    root = etree.fromstring(STREET.encode())
    for _ in range(chance.choice((1, 1, 2, 4, 8))):
        nodes = list(root.iter())
        node = chance.choice(nodes)
        act = chance.random()
        if act < 0.7 and node.attrib:
            node.set(chance.choice(sorted(node.attrib)), chance.choice(NUMBERS))
        elif act < 0.8 and node.attrib:
            del node.attrib[chance.choice(sorted(node.attrib))]
        elif node.getparent() is None:
            continue
        elif act < 0.9:
            node.getparent().remove(node)
        else:
            copy = etree.fromstring(etree.tostring(node, with_tail=False))
            (node.getparent() if act < 0.95 else chance.choice(nodes)).append(copy)
    return etree.tostring(root, encoding="unicode")


def use_map(text: str, *, seen: bool) -> None:
    """Do with a map what a server does.

    Raises:
        UserError: it cannot be used.
    """
    facts, opendrive = derive(text), parse(text)
    feet = walls_along(opendrive, facts.ground, 0.6)
    world_map = LoadedMap(name=GENERATED_MAP, text=text, walls=Walls(feet, 1.0), **vars(facts))
    scenery = scenery_of(world_map)
    simulation = World(world_map, EpisodeSettings())
    simulation.step(0.05)
    assert np.isfinite(simulation.episode.actors.pose[: len(simulation.episode.actors)]).all()
    if seen:
        mesh = standing(opendrive, facts, scenery.scene)
        assert np.isfinite(mesh.vertices_m).all()
        here = Obstacles(scenery.statics.centre, scenery.statics.half, scenery.statics.yaw_rad)
        build(surfaces_of(opendrive, facts.ground, facts.lane_of_triangle, facts.lanes["type_bits"]), here)


def test_a_changed_map_is_used_or_refused_by_a_sentence() -> None:
    chance, used = random.Random(SEED), 0
    for number in range(MAPS):
        text = changed_map(chance)
        try:
            use_map(text, seen=number % SEEN == 0)
            used += 1
        except UserError as error:
            assert len(str(error)) > 20  # noqa: PT017 - it may be used as well
        except Exception as error:
            raise AssertionError(f"map {number} of seed {SEED}: {text}") from error
    assert MAPS // 4 < used < MAPS


def whole() -> bytes:
    """A recording in which a car comes, drives, collides, and goes; with most kinds of packets."""
    hero = made.actor(9, "vehicle.tesla.model3", 1, attributes=[(3, "role_name", "hero"), (4, "color", "1,2,3")])
    other = made.actor(10, "walker.pedestrian.0001", 2)
    moving = [
        made.frame(
            number,
            0.05 * number,
            made.positions((9, 100.0 + number, 200, 300, 1, 2, 3), (10, 900, 200, 300, 0, 0, 0)),
            made.several(8, "IfffBi", [(9, 0.25, 0.5, 0.75, 1, -1)]),
            made.several(9, "If", [(10, 1.5)]),
            made.several(12, "I6f", [(9, 1, 2, 3, 4, 5, 6)]),
            made.several(5, "IIIBB", [(number, 9, 10, 1, 0)]),
        )
        for number in range(1, 6)
    ]
    first = made.frame(0, 0.0, made.added(hero, other), made.several(4, "II", [(10, 9)]))
    return b"".join([made.header(map_name="Linden"), first, *moving, made.frame(6, 0.3, made.removed(9, 10))])


ODD = [0, 1, 2, 9, 10, 255, 65_535, 2**31 - 1, 2**32 - 1]
ODD_NUMBERS = [0.0, 1e-40, 3.4e38, -3.4e38, float("nan"), float("inf")]


def changed_recording(chance: random.Random, content: bytes) -> bytes:
    """The bytes with some of them changed, taken out, repeated or cut off."""
    data = bytearray(content)
    for _ in range(chance.choice((1, 1, 2, 4, 8))):
        at, act = chance.randrange(30, len(data)), chance.random()
        if act < 0.4:
            data[at] = chance.choice(ODD) % 256
        elif act < 0.6:
            data[at : at + 4] = struct.pack("<I", chance.choice(ODD))
        elif act < 0.75:
            data[at : at + 4] = struct.pack(
                "<f", chance.choice((0.0, 1e-40, 3.4e38, -3.4e38, float("nan"), float("inf")))
            )
        elif act < 0.85:
            data[at : at + chance.randrange(1, 40)] = b""
        elif act < 0.95:
            data[at:at] = data[at : at + chance.randrange(1, 200)]
        else:
            del data[at:]
        if len(data) < 40:
            break
    return bytes(data)


REPORTS: list[Callable[[Recording], str]] = [
    lambda recording: file_info(recording, show_all=True),
    lambda recording: file_info(recording, show_all=False),
    lambda recording: collisions(recording, "a", "a"),
    lambda recording: blocked(recording, 0.1, 10.0),
]


def use_recording(path: Path, simulation: World) -> None:
    """Do with a recording what a server does.

    Raises:
        RecordingError: it cannot be used.
    """
    with contextlib.suppress(RecordingError), Recording(path) as recording:
        for report in REPORTS:
            assert report(recording)
    track = track_of(Recording(path))
    simulation.replayer.start(simulation, track, ReplayPlan(0.0, 0.0, 9, Transform(), replay_sensors=True))
    for _ in range(4):
        simulation.step(0.05)
    simulation.replayer.stop(keep_actors=False)
    simulation.step(0.05)
    assert np.isfinite(simulation.episode.actors.pose[: len(simulation.episode.actors)]).all()


@pytest.fixture(scope="module")
def street() -> LoadedMap:
    return LoadedMap(name=GENERATED_MAP, text=STREET, **vars(derive(STREET)))


def test_a_changed_recording_is_used_or_refused_by_a_sentence(street: LoadedMap, tmp_path: Path) -> None:
    chance, used, content, path = random.Random(SEED), 0, whole(), tmp_path / "changed.log"
    path.write_bytes(content)
    use_recording(path, World(street, EpisodeSettings()))  # unchanged it is good
    for number in range(RECORDINGS):
        path.write_bytes(changed_recording(chance, content))
        try:
            use_recording(path, World(street, EpisodeSettings()))
            used += 1
        except RecordingError as error:
            assert len(str(error)) > 20  # noqa: PT017 - it may be used as well
        except Exception as error:
            raise AssertionError(f"recording {number} of seed {SEED}: {path.read_bytes()!r}") from error
    assert RECORDINGS // 4 < used < RECORDINGS
