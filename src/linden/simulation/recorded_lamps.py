"""Lamps of streets and houses as records of a recording, and back. Colours there go from 0 to 1."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from linden.recording import layouts
from linden.values.episode import LightState
from linden.values.space import Vector3D

_FULL = 255.0


def records(lamps: Sequence[LightState]) -> NDArray[np.void]:
    """Return lamps as ``layouts.SCENE_LIGHT``."""
    found = [
        (lamp.id, lamp.intensity, (*(part / _FULL for part in lamp.color), 1.0), lamp.active, lamp.group)
        for lamp in lamps
    ]
    return np.array(found, layouts.SCENE_LIGHT)


def states(found: NDArray[np.void]) -> list[LightState]:
    """Return records as lamps; where they are stands nowhere in the file."""
    return [
        LightState(
            lamp_id, Vector3D(), intensity, kind, (_byte(rgba[0]), _byte(rgba[1]), _byte(rgba[2])), active=bool(on)
        )
        for lamp_id, intensity, rgba, on, kind in found.tolist()
    ]


def _byte(share: float) -> int:
    return round(min(max(share, 0.0), 1.0) * _FULL)
