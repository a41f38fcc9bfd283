from pathlib import Path

import pytest

from fakes import recordings as made
from linden.replay.file.read import Recording
from linden.replay.file.reports import collisions

SCENERY = 0xFFFFFFFF
CAST = made.added(
    made.actor(1, "vehicle.tesla.model3", 1),
    made.actor(2, "vehicle.audi.tt", 1),
    made.actor(3, "walker.pedestrian.0001", 2),
    made.actor(4, "traffic.traffic_light", 3),
)


def hits(*pairs: tuple[int, int, int]) -> bytes:
    """Collisions of first, second, whether the first is the hero."""
    return made.several(5, "IIIBB", [(n, first, second, hero, 0) for n, (first, second, hero) in enumerate(pairs)])


FRAMES = (
    made.header(),
    made.frame(1, 0.0, CAST),
    made.frame(2, 1.5, hits((1, 3, 1), (2, SCENERY, 0))),
    made.frame(3, 2.5, hits((1, 3, 1))),
    made.frame(4, 3.5, hits((2, 4, 0))),
    made.frame(5, 4.6, hits((1, 3, 1)), duration_s=-1.0),
)
WALKER = f"v w       1 {'vehicle.tesla.model3':35}      3 {'walker.pedestrian.0001':35}\n"
ROW = {
    "walker": f"       2   {WALKER}",
    "scenery": f"       2   v o       2 {'vehicle.audi.tt':35} 4294967295 {'':35}\n",
    "light": f"       4   v t       2 {'vehicle.audi.tt':35}      4 {'traffic.traffic_light':35}\n",
    "walker again": f"       5   {WALKER}",
}
HEADING = "    Time  Types     Id Actor 1                                 Id Actor 2                            \n"


def report(tmp_path: Path, first: str, second: str) -> str:
    with Recording(made.write(tmp_path, *FRAMES)) as recording:
        return collisions(recording, first, second).split("\n\n", 1)[1]


@pytest.mark.parametrize(
    ("first", "second", "rows"),
    [
        ("a", "a", ["walker", "scenery", "light", "walker again"]),
        ("v", "w", ["walker", "walker again"]),
        ("w", "v", []),
        ("h", "a", ["walker", "walker again"]),
        ("v", "t", ["light"]),
        ("v", "o", ["scenery"]),
    ],
)
def test_a_contact_is_reported_once_while_it_lasts_for_matching_actors(
    tmp_path: Path, first: str, second: str, rows: list[str]
) -> None:
    duration = "5" if rows else "4.6"
    told = "".join(ROW[name] for name in rows)
    assert report(tmp_path, first, second) == f"{HEADING}{told}\nFrames: 5\nDuration: {duration} seconds\n"
