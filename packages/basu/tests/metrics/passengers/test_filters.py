"""The weightings of ISO 2631-1 against the standard's own table, and against filters of an independent kind."""

import math

import numpy as np
import pytest

from basu.metrics.passengers.filters import WD, WF, WK, Weighting, gain, weigh

# ISO 2631-1:1997, table 3 and table 4 (principal weightings in third octaves), factors times 1000, below 10 Hz
THIRDS_HZ = (
    0.1,
    0.125,
    0.16,
    0.2,
    0.25,
    0.315,
    0.4,
    0.5,
    0.63,
    0.8,
    1.0,
    1.25,
    1.6,
    2.0,
    2.5,
    3.15,
    4.0,
    5.0,
    6.3,
    8.0,
)
TABLE_WK = (31.2, 48.6, 79.0, 121, 182, 263, 352, 418, 459, 477, 482, 484, 494, 531, 631, 804, 967, 1039, 1054, 1036)
TABLE_WD = (62.4, 97.3, 158, 243, 365, 530, 713, 853, 944, 992, 1011, 1008, 968, 890, 776, 642, 512, 409, 323, 253)
TABLE_WF = (695, 895, 1006, 992, 854, 619, 384, 224, 116, 53.0)


@pytest.mark.parametrize(
    ("weighting", "table"), [(WK, TABLE_WK), (WD, TABLE_WD), (WF, TABLE_WF)], ids=["Wk", "Wd", "Wf"]
)
def test_the_gains_are_those_of_the_standards_table(weighting: Weighting, table: tuple[float, ...]) -> None:
    frequency_hz = np.array(THIRDS_HZ[: len(table)])  # the table is of nominal frequencies
    assert np.abs(gain(weighting, frequency_hz)) == pytest.approx(
        np.array(table) / 1000.0, rel=0.003
    )  # the table is rounded to three digits


@pytest.mark.parametrize("frequency_hz", [0.5, 1.0, 2.0, 4.0, 8.0])
@pytest.mark.parametrize("weighting", [WD, WK], ids=["Wd", "Wk"])
def test_a_sine_comes_out_weighed(weighting: Weighting, frequency_hz: float) -> None:
    t_s = np.arange(0.0, 120.0, 0.05)
    out = weigh(weighting, np.sin(2.0 * np.pi * frequency_hz * t_s), 0.05)[400:2000]
    expected = abs(gain(weighting, np.array([frequency_hz]))[0]) / math.sqrt(2.0)
    assert np.sqrt(np.mean(out**2)) == pytest.approx(expected, rel=0.003)


def test_a_constant_push_weighs_nothing() -> None:
    assert np.abs(weigh(WD, np.full(200, 3.0), 0.05)).max() < 1e-12


@pytest.mark.parametrize("weighting", [WD, WK], ids=["Wd", "Wk"])
def test_a_braking_is_weighed_as_by_bilinear_filters_at_forty_times_the_rate(weighting: Weighting) -> None:
    fine_s = 0.05 / 40.0
    t_s = np.arange(0.0, 40.0, fine_s)
    braking = -np.interp(t_s, [10.0, 11.0, 13.0, 14.5], [0.0, 2.0, 2.0, 0.0]) + 0.3 * np.sin(2.0 * np.pi * 1.3 * t_s)
    slow = weigh(weighting, braking[::40], 0.05)
    assert np.sqrt(np.mean(slow**2)) == pytest.approx(
        np.sqrt(np.mean(bilinear(weighting, braking, fine_s) ** 2)), rel=0.01
    )


def bilinear(weighting: Weighting, values: np.ndarray, step_s: float) -> np.ndarray:
    """The obvious version: a digital biquad for each part of the weighting, one after the other."""
    w = {name: 2.0 * math.pi * getattr(weighting, f"f{name}_hz") for name in range(1, 7)}
    q = 1.0 / math.sqrt(2.0)
    parts = [
        ((0.0, 0.0, 1.0), (w[1] ** 2, w[1] / q, 1.0)),
        ((1.0, 0.0, 0.0), (1.0, 1.0 / (q * w[2]), 1.0 / w[2] ** 2)),
        ((1.0, 1.0 / w[3], 0.0), (1.0, 1.0 / (weighting.q4 * w[4]), 1.0 / w[4] ** 2)),
    ]
    if math.isfinite(w[5]):
        parts.append(((w[5] ** 2, w[5] / weighting.q5, 1.0), (w[6] ** 2, w[6] / weighting.q6, 1.0)))
    for above, below in parts:
        values = biquad(values, above, below, 2.0 / step_s)
    return values


def biquad(values: np.ndarray, above: tuple[float, ...], below: tuple[float, ...], c: float) -> np.ndarray:
    """Coefficients ascending in s, with s = c (1 - 1/z) / (1 + 1/z)."""
    b = [
        above[0] + above[1] * c + above[2] * c * c,
        2.0 * (above[0] - above[2] * c * c),
        above[0] - above[1] * c + above[2] * c * c,
    ]
    a = [
        below[0] + below[1] * c + below[2] * c * c,
        2.0 * (below[0] - below[2] * c * c),
        below[0] - below[1] * c + below[2] * c * c,
    ]
    out, x1, x2, y1, y2 = [], 0.0, 0.0, 0.0, 0.0
    for x in values.tolist():
        y = (b[0] * x + b[1] * x1 + b[2] * x2 - a[1] * y1 - a[2] * y2) / a[0]
        out.append(y)
        x1, x2, y1, y2 = x, x1, y, y1
    return np.array(out)
