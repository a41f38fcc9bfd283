"""How far actors that another program moved are from the motions of an exported file, and how late those begin."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

EARLY_S, LATE_S = 2.0, 10.0
"""How much earlier and later than in the rehearsal the begin of a motion is looked for."""


class FileMotion(NamedTuple):
    """A motion of an actor in a file."""

    event: str
    points: Array
    """Array of shape (N, 3): s since its begin, x and y in m in CARLA's frame."""


class Fit(NamedTuple):
    """The distance of an actor from its motions, and when each of them begins."""

    worst_m: float
    begins_s: tuple[float, ...]


def motions_in(document: ET.Element) -> tuple[dict[str, list[FileMotion]], dict[str, Array]]:
    """Return each actor's motions in order, and its first place (2,) in m in CARLA's frame."""
    places: dict[str, Array] = {}
    motions: dict[str, list[FileMotion]] = {}
    for private in document.iterfind(".//Init/Actions/Private"):
        place = private.find(".//WorldPosition")
        assert place is not None
        places[private.attrib["entityRef"]] = np.array([float(place.attrib["x"]), -float(place.attrib["y"])])
    for name in places:
        motions[name] = []
    for group in document.iter("ManeuverGroup"):
        actor = group.find(".//EntityRef")
        for event in group.iter("Event"):
            rows = []
            for vertex in event.iter("Vertex"):
                place = vertex.find(".//WorldPosition")
                assert place is not None
                rows.append((float(vertex.attrib["time"]), float(place.attrib["x"]), -float(place.attrib["y"])))
            put = event.find(".//TeleportAction//WorldPosition")
            if put is not None and not rows:
                rows.append((0.0, float(put.attrib["x"]), -float(put.attrib["y"])))
            if rows and actor is not None:
                motions[actor.attrib["entityRef"]].append(FileMotion(event.attrib["name"], np.array(rows)))
    return motions, places


def fit(
    first: Array,
    motions: Sequence[FileMotion],
    due_s: Mapping[str, float],
    driven: Array,
    origin_s: float | None = None,
) -> Fit:
    """Return the greatest distance of driven rows from motions, and when the motions begin so that they fit best.

    Each driven row counts: before the first motion the actor stands at its first place, each motion lasts until the
    next one begins, and after its end the actor stands there. The begins are those with the least sum of the greatest
    distances within each motion.

    Args:
        first: the first place (2,), in m.
        motions: in order.
        due_s: when each motion begins in the rehearsal, in s, by its event.
        driven: rows (M, 3) of time in s, x and y in m.
        origin_s: the begin of the rehearsal in the time of the rows; None: any.

    Returns:
        The distance in m and the begins in s of the run; infinite where a motion cannot have begun.
    """
    times_s, places = driven[:, 0], driven[:, 1:]
    rows = len(times_s)
    sums = np.concatenate([[0.0], np.maximum.accumulate(np.hypot(*(places - first).T))])
    stands, chosen = sums, []
    for motion in motions:
        late_s = np.zeros(rows) if origin_s is None else times_s - origin_s - due_s[motion.event]
        after, begins, worst = np.full(rows + 1, np.inf), np.full(rows + 1, -1), np.full(rows + 1, np.inf)
        for nth in np.flatnonzero((late_s >= -EARLY_S) & (late_s <= LATE_S)):
            later_s = times_s[nth:] - times_s[nth]
            x_m, y_m = (np.interp(later_s, motion.points[:, 0], motion.points[:, column]) for column in (1, 2))
            off = np.hypot(x_m - places[nth:, 0], y_m - places[nth:, 1])
            own = np.concatenate([[0.0], np.maximum.accumulate(off)])
            better = sums[nth] + own < after[nth:]
            after[nth:][better] = (sums[nth] + own)[better]
            begins[nth:][better], worst[nth:][better] = nth, own[better]
        chosen.append((begins, worst))
        sums = after
    end, found, greatest_m = rows, [], 0.0
    for begins, worst in reversed(chosen):
        greatest_m = max(greatest_m, float(worst[end]))
        end = int(begins[end])
        if end < 0:
            return Fit(np.inf, (np.inf,) * len(motions))
        found.append(float(times_s[end]))
    return Fit(max(greatest_m, float(stands[end])), tuple(reversed(found)))
