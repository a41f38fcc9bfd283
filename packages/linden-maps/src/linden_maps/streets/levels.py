"""Bridges and tunnels: how far each node of a network lies above or below the ground.

A street with a level leaves the ground where it crosses a street of another level. It stays at its level between its
nodes, and the streets beyond them come back to the ground by a ramp.
"""

import heapq
from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

from shapely import LineString, STRtree

from linden_maps.streets.curves import length
from linden_maps.streets.network import Network

LEVEL_M = 5.5
"""From a street to the one over it: 16 ft to drive under (AASHTO's Green Book, 2018) and 0.6 m of bridge."""

RAMP = 0.07
"""Mean rise of a ramp; in its middle it rises half as much again."""


class EdgeCrossing(NamedTuple):
    """Two edges that cross without a common node; ``is_separated``: at different levels."""

    edges: tuple[int, int]
    is_separated: bool


def lifts(network: Network, found_crossings: Sequence[EdgeCrossing]) -> tuple[float, ...]:
    """Return how far each node lies above the ground in m, below it as a negative figure."""
    separated = [crossing.edges for crossing in found_crossings if crossing.is_separated]
    raised = {edge: network.edges[edge].street.level for pair in separated for edge in pair}
    found = [0.0] * len(network.nodes)
    for sign in (1, -1):
        heights_m = {edge: LEVEL_M * abs(level) for edge, level in raised.items() if level * sign > 0}
        for node, height_m in _ramped(network, heights_m).items():
            found[node] += sign * height_m
    return tuple(round(lift_m, 3) for lift_m in found)


def crossings(network: Network) -> list[EdgeCrossing]:
    """Return the edges that cross without a common node, each pair once."""
    lines = [LineString(edge.points) for edge in network.edges]
    ones, others = STRtree(lines).query(lines, predicate="intersects")
    pairs = zip(ones.tolist(), others.tolist(), strict=True)
    edges = network.edges
    return [
        EdgeCrossing((one, other), edges[one].street.level != edges[other].street.level)
        for one, other in sorted(pairs)
        if one < other and set(edges[one].nodes).isdisjoint(edges[other].nodes)
    ]


def _ramped(network: Network, heights_m: dict[int, float]) -> dict[int, float]:
    """Return the least height of each node for edges at such heights: what is left of them at the end of ramps."""
    roads = defaultdict(list)
    for edge, road in zip(network.edges, network.roads, strict=True):
        drop_m = 0.0 if road is None else RAMP * length(road)
        for node, far in (edge.nodes, edge.nodes[::-1]):
            roads[node].append((far, drop_m))
    queue = [(-height_m, node) for edge, height_m in heights_m.items() for node in network.edges[edge].nodes]
    heapq.heapify(queue)
    found: dict[int, float] = {}
    while queue:
        negative_m, node = heapq.heappop(queue)
        if node in found:
            continue
        found[node] = -negative_m
        for far, drop_m in roads[node]:
            if far not in found and found[node] > drop_m:
                heapq.heappush(queue, (drop_m - found[node], far))
    return found
