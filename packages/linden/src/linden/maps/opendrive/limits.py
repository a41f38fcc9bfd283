"""Limits and errors of OpenDRIVE files.

An error names the line of the file. A limit is one bound for each count and size, far above real maps: a client can
send a text of some megabytes, which could ask for any amount of memory and time without bounds.
"""

from linden.errors import UserError


class MapError(UserError):
    """An OpenDRIVE text cannot be read: which line, what stands there, what should."""

    def __init__(self, reason: str, line: int | None = None) -> None:
        super().__init__(reason if line is None else f"line {line}: {reason}")
        self.reason = reason
        self.line = line


LARGEST_NUMBER = 1e9
"""Of anything in the text: positions in UTM reach 1e7 m."""
LONGEST_ROAD_M = 200e3
SHORTEST_ROAD_M = 1e-5
"""Ten times the least distance of two samples (``evaluate.sampling``)."""
LONGEST_TOTAL_M = 5e6
"""Of all roads together; Germany's motorways have 13,000 km, a town of 10 km by 10 km 2,000 km."""
WIDEST_EXTENT_M = 50e3
"""From the westernmost to the easternmost road, and from north to south."""
HIGHEST_M = 20e3
WIDEST_LANE_M = 250.0
MOST_LANES = 1000
"""On one side of a road."""
MOST_PLACES = 5_000_000
"""Places where lanes are looked at, of all lanes together; some 2 GB of memory, and 1 million in the largest towns."""
MOST_OVERLAPS = 64
"""Triangles of lanes over one place, on an average; junctions have 10."""
MOST_IN_A_PLACE = 2000
"""Pieces of lanes in one square metre, on the average of all pieces; each look at the ground goes through them. The
middle of a star of 24 legs has some 500."""
MOST_SIGNALS = 10_000
"""Each is an actor, with a row in every snapshot; CARLA's largest towns have some 2,000."""
MOST_SIGNAL_LANES = 2_000_000
"""Lanes at the places of signals and of references to them, each once for every validity. A town with 2,000 signals
has 50,000."""
MOST_SIGNAL_PLACES = 200_000
"""Lanes that signals speak to, of all signals together; a town with 2,000 signals has 10,000."""
MOST_MEETINGS = 500_000
"""Pairs of lanes in junctions that are compared for stop and yield signs; a town with 1,000 of them has 100,000."""
MOST_GIVE_WAY = 200_000
"""Squares before and in junctions to which traffic at signs gives way."""
MOST_ELEMENTS = 3_000_000
"""Of XML; a text of 64 MB has 1 million."""
MOST_CORNERS = 1000
"""Of one outline."""
FARTHEST_CORNER_M = 10e3
"""From the object that an outline belongs to."""
MOST_BARS = 1000
"""Of one crosswalk or yield line: 1.2 km."""
MOST_PAINTED = 50_000
"""Pieces of paint that a map's objects ask for; the rest is left out."""
MOST_FLOOR_CELLS = 500 * 500
"""Square metres that a floor under one junction may take; a larger junction has none."""
MOST_WALL_PIECES = 100
"""Between two places of a road; they are cut for the rise, and a street rises less than 25 m in 10."""
MOST_WALKING_TILES = 20_000
"""Of the mesh that walkers are led on; more land with pavements than a town of 10 km by 10 km has."""


def refuse_beyond(found: float, most: float, what: str, line: int | None = None) -> None:
    """Raise a MapError where a map asks for more than is allowed; ``what`` ends the sentence, such as "signals"."""
    if found > most:
        raise MapError(f"the map has {found:,.0f} {what}; {most:,.0f} are allowed", line)
