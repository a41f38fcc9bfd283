"""Letters of flat strokes for signs: a skeleton for each, on a field 4 wide and 6 tall, its lines given a breadth."""

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

_BREADTH = 0.9
_ADVANCE = 5.2
_STROKES: dict[str, str] = {
    "0": "00-40 40-46 46-06 06-00",
    "1": "20-26 26-15",
    "2": "06-46 46-43 43-03 03-00 00-40",
    "3": "06-46 46-40 40-00 03-43",
    "4": "06-03 03-43 46-40",
    "5": "46-06 06-03 03-43 43-40 40-00",
    "6": "46-06 06-00 00-40 40-43 43-03",
    "7": "06-46 46-10",
    "8": "00-40 40-46 46-06 06-00 03-43",
    "9": "43-03 03-06 06-46 46-40 40-00",
    "D": "00-06 06-36 36-45 45-41 41-30 30-00",
    "E": "00-06 06-46 03-33 00-40",
    "I": "20-26",
    "L": "06-00 00-40",
    "M": "00-06 06-23 23-46 46-40",
    "O": "10-30 30-41 41-45 45-36 36-16 16-05 05-01 01-10",
    "P": "00-06 06-46 46-43 43-03",
    "S": "46-06 06-03 03-43 43-40 40-00",
    "T": "20-26 06-46",
    "Y": "06-23 46-23 23-20",
}
"""Lines between points of the field, each named by its two coordinates."""


def letters(text: str, tall_m: float) -> list[F64]:
    """Return strokes (4, 2) of a line of text around its middle: x to the reader's right, y up, in m.

    Raises:
        KeyError: there is no such letter here.
    """
    unit = tall_m / (6.0 + _BREADTH)
    wide = _ADVANCE * (len(text) - 1) + 4.0
    found = []
    for nth, letter in enumerate(text):
        for line in _STROKES[letter].split():
            begin, end = (np.array([float(point[0]), float(point[1])]) for point in line.split("-"))
            along = (end - begin) / np.hypot(*(end - begin))
            side = np.array([-along[1], along[0]]) * 0.5 * _BREADTH
            begin, end = begin - 0.5 * _BREADTH * along, end + 0.5 * _BREADTH * along
            corners = np.stack([begin - side, end - side, end + side, begin + side])
            found.append((corners + np.array([_ADVANCE * nth - 0.5 * wide, -3.0])) * unit)
    return found
