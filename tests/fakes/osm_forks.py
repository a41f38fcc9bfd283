"""OpenStreetMap extracts of streets that meet at any angle: forks, stars, carriageways that join, and random ones."""

import math
import random
from collections.abc import Iterable

from fakes.osm_quarter import Drawing

Place = tuple[float, float]


def ray(angle_deg: float, *distances_m: float) -> list[Place]:
    """Return places on a line from the origin."""
    turn = math.radians(angle_deg)
    return [(round(m * math.cos(turn), 3), round(m * math.sin(turn), 3)) for m in (0.0, *distances_m)]


def star(angles_deg: Iterable[float], **tags: str) -> bytes:
    """Return streets of 100 m that meet in one node."""
    draw = Drawing()
    for number, angle_deg in enumerate(angles_deg, start=1):
        draw.way(number, *ray(angle_deg, 50.0, 100.0), **{"highway": "residential", **tags})
    return draw.text()


def fork(angle_deg: float, **tags: str) -> bytes:
    """Return a street with two lanes each way that goes on straight, and one that leaves it at an angle."""
    draw = Drawing()
    draw.way(1, (-120.0, 0.0), (0.0, 0.0), (120.0, 0.0), highway="secondary", lanes="4", name="Main Street")
    draw.way(2, *ray(angle_deg, 60.0, 120.0), **{"highway": "residential", "lanes": "2", **tags})
    return draw.text()


def joining_carriageways(apart_m: float, over_m: float) -> bytes:
    """Return two one-way carriageways that join into one street."""
    draw = Drawing()
    half_m = apart_m / 2
    main = {"highway": "primary", "name": "Main Street"}
    draw.way(1, (0.0, 0.0), (over_m, -half_m), (200.0, -half_m), oneway="yes", lanes="2", **main)
    draw.way(2, (200.0, half_m), (over_m, half_m), (0.0, 0.0), oneway="yes", lanes="2", **main)
    draw.way(3, (-150.0, 0.0), (0.0, 0.0), lanes="4", **main)
    return draw.text()


def mapped_twice() -> bytes:
    """Return a street that two ways describe, the second against the first, and one that meets it."""
    draw = Drawing()
    draw.way(1, (-100.0, 0.0), (0.0, 0.0), (100.0, 5.0), highway="residential", name="Main Street")
    draw.way(2, (100.0, 5.0), (0.0, 0.0), (-100.0, 0.0), highway="residential", name="Main Street")
    draw.way(3, (0.0, 0.0), (0.0, 90.0), highway="residential", name="Side Street")
    return draw.text()


def tangle(seed: int) -> bytes:
    """Return up to eight streets from one place: any angles, lanes, widths, directions, and sides from 2 m on."""
    dice, draw = random.Random(seed), Drawing()
    for number in range(1, dice.randint(3, 9)):
        flat = dice.choice((0.0, 180.0)) + dice.uniform(-15.0, 15.0)
        heading_rad = math.radians(dice.choice((dice.uniform(0.0, 360.0), flat)))
        x_m = y_m = 0.0
        places = [(x_m, y_m)]
        for _ in range(dice.randint(1, 4)):
            side_m = dice.choice((2.0, 5.0, 12.0, 40.0, 80.0))
            x_m, y_m = x_m + side_m * math.cos(heading_rad), y_m + side_m * math.sin(heading_rad)
            places.append((round(x_m, 3), round(y_m, 3)))
            heading_rad += dice.uniform(-0.6, 0.6)
        options = {
            "lanes": str(dice.randint(1, 6)),
            "oneway": dice.choice(("yes", "-1")),
            "width": str(dice.randint(3, 30)),
            "maxspeed": dice.choice(("30", "50", "25 mph")),
            "junction": "roundabout",
        }
        shares = {"lanes": 0.5, "oneway": 0.3, "width": 0.3, "maxspeed": 0.3, "junction": 0.05}
        tags = {key: value for key, value in options.items() if dice.random() < shares[key]}
        tags["highway"] = dice.choice(("residential", "service", "secondary", "primary"))
        draw.way(number, *places, **tags)
    return draw.text()


def bridge(*, layer: str = "1", kind: str = "bridge") -> bytes:
    """Return a street whose middle passes over (or under) another, and two that cross at one height."""
    draw = Drawing()
    draw.way(1, (-200.0, 0.0), (-30.0, 0.0), highway="secondary", name="High Street")
    draw.way(2, (-30.0, 0.0), (30.0, 0.0), highway="secondary", name="High Street", layer=layer, **{kind: "yes"})
    draw.way(3, (30.0, 0.0), (200.0, 0.0), highway="secondary", name="High Street")
    draw.way(4, (0.0, -150.0), (0.0, 150.0), highway="residential", name="Low Street")
    draw.way(5, (-100.0, -100.0), (100.0, -100.0), highway="residential", name="Level Street")
    return draw.text()
