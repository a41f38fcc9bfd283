"""An OpenStreetMap extract drawn by hand: a quarter of South Linden's dimensions, with every kind of control.

Blocks are 120 m by 180 m as between Cleveland Ave and Hamilton Ave; an arterial with four lanes runs north. Places are
given in metres about 40.0 N, 83.0 W, and written as degrees.
"""

import math
from xml.sax.saxutils import quoteattr

ORIGIN = (-83.0, 40.0)


def lonlat(x_m: float, y_m: float) -> tuple[float, float]:
    """Degrees of a place; good to a decimetre within a kilometre."""
    scale = 111_412.0 * math.cos(math.radians(ORIGIN[1])) * 0.99967
    return round(ORIGIN[0] + x_m / scale, 7), round(ORIGIN[1] + y_m / 111_035.0, 7)


class Drawing:
    """Nodes and ways, collected and written as OSM XML."""

    def __init__(self) -> None:
        self._nodes: dict[tuple[float, float], int] = {}
        self._tags: dict[int, dict[str, str]] = {}
        self._ways: list[tuple[int, list[int], dict[str, str]]] = []
        self._relations: list[str] = []

    def node(self, x_m: float, y_m: float, **tags: str) -> int:
        """Return the node at a place, new or known; add tags to it."""
        number = self._nodes.setdefault((x_m, y_m), 1000 + len(self._nodes))
        self._tags.setdefault(number, {}).update({key.replace("__", ":"): value for key, value in tags.items()})
        return number

    def way(self, number: int, *places: tuple[float, float], **tags: str) -> None:
        """Add a way through places."""
        nodes = [self.node(*place) for place in places]
        self._ways.append((number, nodes, {key.replace("__", ":"): value for key, value in tags.items()}))

    def building(self, number: int, *corners: tuple[float, float], **tags: str) -> None:
        """Add a closed way with the tag building."""
        self.way(number, *corners, corners[0], **{"building": "yes", **tags})

    def relation(self, number: int, outer: int, **tags: str) -> None:
        """Add a multipolygon of one outer way."""
        inner = "".join(f"<tag k={quoteattr(k)} v={quoteattr(v)}/>" for k, v in tags.items())
        self._relations.append(
            f'<relation id="{number}"><member type="way" ref="{outer}" role="outer"/>'
            f'<tag k="type" v="multipolygon"/>{inner}</relation>'
        )

    def text(self) -> bytes:
        """Return the extract."""
        lines = ['<?xml version="1.0" encoding="UTF-8"?>', '<osm version="0.6" generator="drawn by hand">']
        for (x_m, y_m), number in self._nodes.items():
            lon, lat = lonlat(x_m, y_m)
            lines.append(f'<node id="{number}" lon="{lon}" lat="{lat}">{_tags(self._tags[number])}</node>')
        for number, nodes, tags in self._ways:
            refs = "".join(f'<nd ref="{node}"/>' for node in nodes)
            lines.append(f'<way id="{number}">{refs}{_tags(tags)}</way>')
        return "\n".join([*lines, *self._relations, "</osm>"]).encode()


def _tags(tags: dict[str, str]) -> str:
    return "".join(f"<tag k={quoteattr(key)} v={quoteattr(value)}/>" for key, value in tags.items())


def ring(x_m: float, y_m: float, radius_m: float, count: int) -> list[tuple[float, float]]:
    """Return points of a circle, counter-clockwise from the east, closed."""
    turns = [math.tau * i / count for i in range(count)]
    points = [(round(x_m + radius_m * math.cos(a), 3), round(y_m + radius_m * math.sin(a), 3)) for a in turns]
    return [*points, points[0]]


def quarter() -> Drawing:
    """Return the quarter: see the comments for what each street shows."""
    draw = Drawing()
    # an arterial with four lanes and lights at its middle crossing; its limit is tagged
    draw.way(
        1, (0.0, -300.0), (0.0, -120.0), (0.0, 0.0), (0.0, 120.0), (0.0, 300.0),
        highway="primary", name="Cleveland Avenue", lanes="4", maxspeed="35 mph", sidewalk="both", width="14.6",
    )  # fmt: skip
    draw.node(0.0, 0.0, highway="traffic_signals")
    # two ways of one street, equal in all: one street; three lanes, two of them towards the east
    east = (0.0, 0.0), (16.0, 0.0), (90.0, 0.0), (180.0, 0.0), (400.0, 0.0)
    for number, places in ((2, ((-400.0, 0.0), (-180.0, 0.0), (0.0, 0.0))), (3, east)):
        draw.way(
            number, *places, highway="secondary", name="East 11th Avenue", lanes="3", lanes__forward="2",
            lanes__backward="1", maxspeed="25 mph", sidewalk__both="yes",
        )  # fmt: skip
    # side streets with stop signs on the way before the arterial, direction given
    circle = ring(-180.0, 120.0, 9.0, 8)
    draw.way(4, circle[0], (-12.0, 120.0), (0.0, 120.0), highway="residential", name="East 12th Avenue")
    draw.node(-12.0, 120.0, highway="stop", direction="forward")
    draw.way(5, (0.0, 120.0), (12.0, 120.0), (180.0, 120.0), highway="residential", name="East 12th Avenue")
    draw.node(12.0, 120.0, highway="stop", direction="backward")
    # a side street whose sign nothing tells of: the lower class waits, as a guess
    draw.way(6, (0.0, -120.0), (180.0, -120.0), highway="residential", name="Bonham Avenue", parking__both="lane")
    # a street with parking and an all-way stop where it crosses 12th Avenue
    draw.way(
        7, (180.0, -120.0), (180.0, 0.0), (180.0, 120.0), (180.0, 300.0), highway="residential", name="Brooks Avenue",
        parking__both="lane", width="10 m",
    )  # fmt: skip
    draw.way(8, (180.0, 120.0), (400.0, 120.0), highway="residential", name="East 12th Avenue")
    draw.node(180.0, 120.0, highway="stop", stop="all")
    draw.node(180.0, 0.0, highway="give_way", direction="forward")  # on the junction: its street is not known
    # a small roundabout as a ring of two ways
    draw.way(9, *circle[:5], highway="residential", junction="roundabout", oneway="yes", name="Circle")
    draw.way(10, *circle[4:], highway="residential", junction="roundabout", oneway="yes", name="Circle")
    draw.way(11, (-180.0, 0.0), circle[6], highway="residential", name="Hamilton Avenue")
    draw.way(12, circle[2], (-180.0, 300.0), (-180.0, 420.0), highway="residential", name="Hamilton Avenue")
    draw.way(13, circle[4], (-400.0, 120.0), highway="residential", name="East 12th Avenue")
    # a large roundabout with lanes of its own
    large = ring(400.0, 300.0, 24.0, 16)
    draw.way(14, *large, highway="tertiary", junction="roundabout", name="Great Circle", maxspeed="15 mph")
    draw.way(15, (180.0, 300.0), large[8], highway="tertiary", name="East 17th Avenue", maxspeed="25 mph")
    draw.way(16, large[12], (400.0, 120.0), highway="tertiary", name="Joyce Avenue", maxspeed="25 mph")
    draw.way(17, large[0], (600.0, 300.0), highway="tertiary", name="East 17th Avenue", maxspeed="25 mph")
    draw.way(18, (400.0, 120.0), (400.0, 0.0), highway="tertiary", name="Joyce Avenue", maxspeed="25 mph")
    # one-way streets: with, and against, the order of their nodes
    draw.way(19, (180.0, 300.0), (0.0, 300.0), highway="residential", name="East 13th Avenue", oneway="yes", lanes="2")
    draw.way(20, (-180.0, 300.0), (0.0, 300.0), highway="residential", name="East 13th Avenue", oneway="-1")
    # crossings: between junctions, and just before the lights
    draw.node(90.0, 0.0, highway="crossing", crossing="marked")
    draw.node(16.0, 0.0, highway="crossing", crossing="traffic_signals")
    # what is no street of ours
    draw.way(30, (90.0, 0.0), (90.0, 60.0), highway="footway")
    draw.way(31, (60.0, 0.0), (60.0, -40.0), highway="service", service="driveway")
    # buildings: with a height, with storeys, without either, L-shaped, over the street, as a relation
    draw.building(40, (20.0, 20.0), (34.0, 20.0), (34.0, 30.0), (20.0, 30.0), height="7.5", name="Corner Shop")
    draw.building(41, (40.0, 20.0), (52.0, 20.0), (52.0, 30.0), (40.0, 30.0), building__levels="3")
    draw.building(42, (60.0, 20.0), (68.0, 20.0), (68.0, 30.0), (60.0, 30.0), building="garage")
    draw.building(
        43, (80.0, 20.0), (110.0, 20.0), (110.0, 28.0), (90.0, 28.0), (90.0, 45.0), (80.0, 45.0), height="9 m"
    )
    draw.building(44, (-6.0, 200.0), (6.0, 200.0), (6.0, 210.0), (-6.0, 210.0), height="6")
    draw.way(45, (120.0, 20.0), (140.0, 20.0), (140.0, 40.0), (120.0, 40.0), (120.0, 20.0))
    draw.relation(50, 45, building="school", name="Windsor Academy")
    draw.node(30.0, 9.0, amenity="bench")
    draw.node(33.0, 9.0, amenity="waste_basket")
    draw.node(36.0, 9.0, amenity="post_box")
    return draw
