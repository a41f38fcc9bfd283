"""A Lanelet2 map in the making, to which the parts of the conversion add what they know."""

from collections import defaultdict

from linden.maps.opendrive.evaluate.pieces import F64
from linden.maps.opendrive.evaluate.tables import Tables
from linden_maps.lanelet2.model import Bounds, Ids, LaneletMap, LaneletPoint, LaneletWay, Member, Relation
from linden_maps.lanelet2.stretches import LaneletNetwork, Side


class LaneletDraft:
    """A map in the making: lanelets by stretch, with their regulatory elements in order."""

    def __init__(self, tables: Tables, network: LaneletNetwork) -> None:
        self.tables, self.network = tables, network
        self.target, self.ids = LaneletMap(), Ids()
        self.tags: dict[int, dict[str, str]] = {}
        self.elements: dict[int, list[int]] = defaultdict(list)  # of each lanelet
        self.lanelet_of: list[int] = []
        self.bounds: dict[int, Bounds] = {}  # of each lanelet
        self.way_of: dict[Side, int] = {}
        self.nodes_of: dict[Side, tuple[int, ...]] = {}  # in ascending s
        self.bulbs_of: dict[int, int] = {}  # of each light

    def add_line(self, points: F64, tags: dict[str, str], *key: object, small_id: bool = False) -> int:
        """Add a way of its own nodes, and return its id; a small one where tags name it."""
        nodes = []
        for nth, point in enumerate(points.tolist()):
            node = self.ids.new("node", *key, nth)
            self.target.nodes[node] = LaneletPoint(*point)
            nodes.append(node)
        way = (self.ids.small if small_id else self.ids.new)("way", *key)
        self.target.ways[way] = LaneletWay(tuple(nodes), tags)
        return way

    def add_element(self, subtype: str, members: list[Member], lanelets: list[int], *key: object) -> int:
        """Add a regulatory element, let lanelets refer to it, and return its id."""
        number = self.ids.new("element", subtype, *key)
        self.target.relations[number] = Relation(tuple(members), {"type": "regulatory_element", "subtype": subtype})
        for lanelet in dict.fromkeys(lanelets):
            self.elements[lanelet].append(number)
        return number
