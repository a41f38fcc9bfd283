"""The files of an Aisan vector map: names, columns, and rows as text.

Frame: Bx is the northing and Ly the easting in m, H the height; directions are clockwise from north. Source of columns:
vector_map_msgs and the stream operators of vector_map (Autoware.AI 1.13); the map's own specification is not public.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

COLUMNS: dict[str, tuple[str, ...]] = {
    "point": ("PID", "B", "L", "H", "Bx", "Ly", "ReF", "MCODE1", "MCODE2", "MCODE3"),
    "node": ("NID", "PID"),
    "line": ("LID", "BPID", "FPID", "BLID", "FLID"),
    "area": ("AID", "SLID", "ELID"),
    "vector": ("VID", "PID", "Hang", "Vang"),
    "pole": ("PLID", "VID", "Length", "Dim"),
    "lane": (
        *("LnID", "DID", "BLID", "FLID", "BNID", "FNID", "JCT", "BLID2", "BLID3", "BLID4", "FLID2", "FLID3"),
        *("FLID4", "ClossID", "Span", "LCnt", "Lno", "LaneType", "LimitVel", "RefVel", "RoadSecID", "LaneChgFG"),
        "LinkWAID",
    ),
    "dtlane": ("DID", "Dist", "PID", "Dir", "Apara", "r", "slope", "cant", "LW", "RW"),
    "wayarea": ("WAID", "AID"),
    "whiteline": ("ID", "LID", "Width", "Color", "type", "LinkID"),
    "stopline": ("ID", "LID", "TLID", "SignID", "LinkID"),
    "roadsign": ("ID", "VID", "PLID", "Type", "LinkID"),
    "signaldata": ("ID", "VID", "PLID", "Type", "LinkID"),
    "poledata": ("ID", "PLID", "LinkID"),
    "intersection": ("ID", "AID", "LinkID"),
    "crosswalk": ("ID", "AID", "Type", "BdID", "LinkID"),
    "roadedge": ("ID", "LID", "LinkID"),
    "curb": ("ID", "LID", "Height", "Width", "Dir", "LinkID"),
    "sidewalk": ("ID", "AID", "LinkID"),
}
"""Columns by file, in the order in which the loader reads them; it ignores their names."""

KINDS = {
    "poledata": "K001",
    "roadsign": "K003",
    "signaldata": "K004",
    "whiteline": "P001",
    "stopline": "P002",
    "crosswalk": "P004",
    "roadedge": "R001",
    "curb": "R003",
}
"""Kinds in idx.csv, as far as they are known."""

STRAIGHT_R = 90000000000
"""What dtlane's r says of a straight piece."""


@dataclass(slots=True)
class Tables:
    """Rows by file, without their first column where that is a running number; ids begin at 1, 0 means none."""

    rows: dict[str, list[str]] = field(default_factory=lambda: {name: [] for name in COLUMNS})

    def add(self, name: str, *values: object) -> int:
        """Append a row and return its id, the first column."""
        rows = self.rows[name]
        number = len(rows) + 1
        rows.append(f"{number},{','.join(map(str, values))}")
        return number

    def extend(self, name: str, rows: Iterable[str]) -> None:
        """Append whole rows; their first columns continue the count."""
        self.rows[name].extend(rows)

    def next_id(self, name: str) -> int:
        """Return the id of the next row."""
        return len(self.rows[name]) + 1

    def chain(self, points: Sequence[int], *, closed: bool) -> tuple[int, int]:
        """Append the lines along points, with consecutive ids; return the first and the last."""
        following = [*points[1:], points[0]] if closed else list(points[1:])
        starts = points if closed else points[:-1]
        first = self.next_id("line")
        last = first + len(starts) - 1
        self.extend(
            "line",
            (
                f"{number},{start},{end},{number - 1 if number > first else 0},{number + 1 if number < last else 0}"
                for number, start, end in zip(range(first, last + 1), starts, following, strict=True)
            ),
        )
        return first, last

    def files(self) -> dict[str, bytes]:
        """Return the bytes of each file that has rows, and the index of the files."""
        found = {
            f"{name}.csv": "\n".join([",".join(COLUMNS[name]), *rows, ""]).encode()
            for name, rows in self.rows.items()
            if rows
        }
        kinds = [f"{kind},{name}.csv" for name, kind in KINDS.items() if f"{name}.csv" in found]
        index = [f"{number},{line}" for number, line in enumerate(kinds, start=1)]
        return {**found, "idx.csv": "\n".join(["ID,KIND,fname", *index, ""]).encode()}
