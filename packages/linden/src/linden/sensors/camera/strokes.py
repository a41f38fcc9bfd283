"""Pictures of lines and areas in colours on black, without light and without scenery: ``cosmos_visualization``.

Lines have a width in m and face the eye, as Unreal's line batches do; what is nearer covers what is farther. Nothing of
the scene hides them, since CARLA's camera shows its lines alone.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.compiled import unlocked
from linden.geometry import rotation_matrix
from linden.protocol.values.space import Transform
from linden.sensors.camera.spec import CameraSpec

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]

NEAR_M = 0.1
"""Nothing nearer along the camera's axis is drawn; Unreal's near plane lies at 10 cm."""


class Strokes(NamedTuple):
    """Lines and triangles in the world, m, in CARLA's frame."""

    start_m: F64  # (N, 3)
    end_m: F64  # (N, 3)
    width_m: F64  # (N,)
    line_colour: U8  # (N, 3) R, G, B
    corners_m: F64  # (T, 3, 3)
    area_colour: U8  # (T, 3) R, G, B

    @classmethod
    def none(cls) -> "Strokes":
        """Return a set of strokes that is empty."""
        return cls(
            np.empty((0, 3)), np.empty((0, 3)), np.empty(0), np.empty((0, 3), np.uint8),
            np.empty((0, 3, 3)), np.empty((0, 3), np.uint8),
        )  # fmt: skip


def joined(parts: list[Strokes]) -> Strokes:
    """Return all strokes of several."""
    return Strokes(*(np.concatenate(columns) for columns in zip(Strokes.none(), *parts, strict=True)))


def draw(spec: CameraSpec, pose: Transform, strokes: Strokes) -> U8:
    """Return the picture, (height, width, 4) bytes B, G, R, A, top row first.

    Args:
        spec: the size and the field of view; the lens does not bend the picture.
        pose: of the camera, in the world.
        strokes: what there is to be seen.
    """
    image = np.zeros((spec.height_px, spec.width_px, 4), np.uint8)
    image[:, :, 3] = 255
    nearness = np.zeros((spec.height_px, spec.width_px), np.float32)
    camera = rotation_matrix(pose.rotation), np.asarray(pose.location)
    start_m, end_m, corners_m = (
        np.ascontiguousarray((points - camera[1]) @ camera[0])
        for points in (strokes.start_m, strokes.end_m, strokes.corners_m)
    )
    paint_areas(corners_m, strokes.area_colour, spec.focal_px, image, nearness)
    paint_lines(start_m, end_m, strokes.width_m, strokes.line_colour, spec.focal_px, image, nearness)
    return image


@unlocked
def paint_lines(start_m: F64, end_m: F64, width_m: F64, colour: U8, focal_px: float, image: U8, nearness: F32) -> None:
    """Paint lines in the camera's frame, m: forward, right, up. ``nearness`` is 1/m of what a pixel shows."""
    height, width = nearness.shape
    for n in range(len(start_m)):
        a0, a1, a2 = start_m[n, 0], start_m[n, 1], start_m[n, 2]
        b0, b1, b2 = end_m[n, 0], end_m[n, 1], end_m[n, 2]
        if a0 < NEAR_M and b0 < NEAR_M:
            continue
        if a0 < NEAR_M or b0 < NEAR_M:
            share = (NEAR_M - a0) / (b0 - a0)
            c1, c2 = a1 + share * (b1 - a1), a2 + share * (b2 - a2)
            if a0 < NEAR_M:
                a0, a1, a2 = NEAR_M, c1, c2
            else:
                b0, b1, b2 = NEAR_M, c1, c2
        ax, ay = 0.5 * width + focal_px * a1 / a0, 0.5 * height - focal_px * a2 / a0
        bx, by = 0.5 * width + focal_px * b1 / b0, 0.5 * height - focal_px * b2 / b0
        wide_a = max(0.5, 0.5 * focal_px * width_m[n] / a0)
        wide_b = max(0.5, 0.5 * focal_px * width_m[n] / b0)
        most = max(wide_a, wide_b)
        first_x, last_x = max(0.0, min(ax, bx) - most), min(width - 1.0, max(ax, bx) + most)
        first_y, last_y = max(0.0, min(ay, by) - most), min(height - 1.0, max(ay, by) + most)
        if first_x > last_x or first_y > last_y:
            continue
        dx, dy = bx - ax, by - ay
        long2 = dx * dx + dy * dy
        for row in range(int(first_y), int(last_y) + 1):
            for column in range(int(first_x), int(last_x) + 1):
                px, py = column + 0.5 - ax, row + 0.5 - ay
                t = 0.0 if long2 == 0.0 else min(1.0, max(0.0, (px * dx + py * dy) / long2))
                off_x, off_y = px - t * dx, py - t * dy
                wide = wide_a + t * (wide_b - wide_a)
                if off_x * off_x + off_y * off_y > wide * wide:
                    continue
                near = np.float32((1.0 - t) / a0 + t / b0)
                if near > nearness[row, column]:
                    nearness[row, column] = near
                    image[row, column, 0] = colour[n, 2]
                    image[row, column, 1] = colour[n, 1]
                    image[row, column, 2] = colour[n, 0]


@unlocked
def paint_areas(  # noqa: C901 - one loop over triangles, cut and painted
    corners_m: F64, colour: U8, focal_px: float, image: U8, nearness: F32
) -> None:
    """Paint triangles in the camera's frame, m: forward, right, up; the part before the near plane is cut off."""
    height, width = nearness.shape
    polygon = np.empty((4, 3))
    for n in range(len(corners_m)):
        count = 0
        for k in range(3):
            m = (k + 1) % 3
            this, other = corners_m[n, k, 0], corners_m[n, m, 0]
            if this >= NEAR_M:
                polygon[count] = corners_m[n, k]
                count += 1
            if (this >= NEAR_M) != (other >= NEAR_M):
                share = (NEAR_M - this) / (other - this)
                polygon[count] = corners_m[n, k] + share * (corners_m[n, m] - corners_m[n, k])
                count += 1
        for k in range(1, count - 1):
            i0, i1, i2 = 1.0 / polygon[0, 0], 1.0 / polygon[k, 0], 1.0 / polygon[k + 1, 0]
            x0, y0 = 0.5 * width + focal_px * polygon[0, 1] * i0, 0.5 * height - focal_px * polygon[0, 2] * i0
            x1, y1 = 0.5 * width + focal_px * polygon[k, 1] * i1, 0.5 * height - focal_px * polygon[k, 2] * i1
            x2, y2 = 0.5 * width + focal_px * polygon[k + 1, 1] * i2, 0.5 * height - focal_px * polygon[k + 1, 2] * i2
            area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
            first_x, last_x = max(0.0, min(x0, x1, x2)), min(width - 1.0, max(x0, x1, x2))
            first_y, last_y = max(0.0, min(y0, y1, y2)), min(height - 1.0, max(y0, y1, y2))
            if area == 0.0 or first_x > last_x or first_y > last_y:
                continue
            for row in range(int(first_y), int(last_y) + 1):
                for column in range(int(first_x), int(last_x) + 1):
                    px, py = column + 0.5, row + 0.5
                    u = ((px - x0) * (y2 - y0) - (x2 - x0) * (py - y0)) / area
                    v = ((x1 - x0) * (py - y0) - (px - x0) * (y1 - y0)) / area
                    if u < 0.0 or v < 0.0 or u + v > 1.0:
                        continue
                    near = np.float32(i0 + u * (i1 - i0) + v * (i2 - i0))
                    if near > nearness[row, column]:
                        nearness[row, column] = near
                        image[row, column, 0] = colour[n, 2]
                        image[row, column, 1] = colour[n, 1]
                        image[row, column, 2] = colour[n, 0]
