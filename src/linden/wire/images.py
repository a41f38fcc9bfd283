"""Pictures as bytes: what stands between the sensor's header and the pixels, and events of an event camera.

Source: LibCarla 0.9.16, ``carla/sensor/s11n/ImageSerializer.h``, ``DVSEventArraySerializer.h``.
"""

import struct

import numpy as np
from numpy.typing import NDArray

from linden.errors import ProtocolError
from linden.wire.stream import Parts

_HEADER = struct.Struct("<IIf")  # width and height in pixels, horizontal field of view in degrees


def image_payload(pixels: NDArray[np.uint8] | NDArray[np.float32], fov_deg: float) -> Parts:
    """Return a picture (height, width, 4) of bytes B, G, R, A or (height, width, 2) of floats.

    Raises:
        ProtocolError: the pixels are of another form.
    """
    if pixels.ndim != 3 or (pixels.shape[2], pixels.dtype.name) not in ((4, "uint8"), (2, "float32")):
        raise ProtocolError(f"a picture has 4 bytes or 2 floats a pixel, not {pixels.shape} of {pixels.dtype}")
    height, width = pixels.shape[:2]
    return _HEADER.pack(width, height, fov_deg), np.ascontiguousarray(pixels)


def events_payload(events: NDArray[np.void], width: int, height: int, fov_deg: float) -> Parts:
    """Return what an event camera saw, packed events one after the other."""
    return _HEADER.pack(width, height, fov_deg), np.ascontiguousarray(events)
