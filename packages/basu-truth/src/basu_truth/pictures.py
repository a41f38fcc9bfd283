"""Pictures of cameras as PNG files, with the same bytes for the same picture."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

from basu.files import write_bytes
from basu_truth.views import picture_of

if TYPE_CHECKING:
    from pathlib import Path

    import carla


def write_picture(path: Path, measured: carla.Image) -> None:
    """Write a picture as PNG, red, green and blue."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_bytes(path, png_of(measured))


def png_of(measured: carla.Image) -> bytes:
    """Return a picture as PNG, red, green and blue."""
    stream = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(picture_of(measured)[:, :, 2::-1])).save(stream, "PNG", compress_level=3)
    return stream.getvalue()
