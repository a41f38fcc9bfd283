"""Pixels of objects in pictures of instances: how many each has, how many it would have alone, and what hides it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from basu_truth.truth import Rectangle

if TYPE_CHECKING:
    from collections.abc import Mapping

Numbers = NDArray[np.int64]

PARKED_FROM = 0x8000
"""Things of the map that are no actors have numbers from here on in a picture of instances."""


class Count(NamedTuple):
    """Pixels of one object in one picture."""

    visible: int
    whole: int
    hidden_by_actors: int
    hidden_by_scenery: int
    rectangle: Rectangle
    whole_rectangle: Rectangle


def numbers_of(picture: NDArray[np.uint8]) -> Numbers:
    """Return the number of the actor or thing of each pixel (H, W) of a picture (H, W, 4) of instances."""
    return picture[:, :, 1].astype(np.int64) + 256 * picture[:, :, 0].astype(np.int64)


def tags_of(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the semantic tag of each pixel (H, W)."""
    return picture[:, :, 2]


def rectangles(numbers: Numbers) -> dict[int, Rectangle]:
    """Return the rectangle around the pixels of each number but 0."""
    known, labels = np.unique(numbers, return_inverse=True)
    slices = ndimage.find_objects(labels.reshape(numbers.shape) + 1)
    return {
        int(number): _rectangle(found)
        for number, found in zip(known, slices, strict=True)
        if number != 0 and found is not None
    }


def count(scene: Numbers, number: int, alone: Numbers, alone_number: int, seen: Mapping[int, Rectangle]) -> Count:
    """Return the pixels of an object.

    Args:
        scene: numbers (H, W) of the picture with everything in it.
        number: of the object in the scene.
        alone: numbers of the same camera's picture without anything in front of the object.
        alone_number: of the object in that picture.
        seen: the rectangles of the scene, by number.
    """
    visible, bare = scene == number, alone == alone_number
    whole = visible | bare
    hidden = scene[bare & ~visible]
    by_actors = int(np.count_nonzero((hidden > 0) & (hidden < PARKED_FROM)))
    rows, columns = np.flatnonzero(whole.any(1)), np.flatnonzero(whole.any(0))
    span = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    return Count(
        int(np.count_nonzero(visible)),
        int(np.count_nonzero(whole)),
        by_actors,
        len(hidden) - by_actors,
        seen[number],
        _rectangle(span),
    )


def _rectangle(found: tuple[slice, ...]) -> Rectangle:
    """Return the rectangle of the rows and columns of a mask."""
    rows, columns = found
    return Rectangle(
        float(columns.start), float(rows.start), float(columns.stop - columns.start), float(rows.stop - rows.start)
    )
