"""Claims about the search for a boundary: it finds a known one with few drives, and repeats by its seed."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from basu.campaigns.settings import Search
from basu_search.boundary_search import APART, BoundarySearch
from basu_search.findings import MAY, SURE
from basu_search.rounds import Known, Round, round_sizes, space_filling
from basu_search.surrogate import Surrogate
from boundary_regions import HELD_OUT
from boundary_regions import searched as drives_in

Points = NDArray[np.float64]
Fails = Callable[[Points], NDArray[np.bool_]]


def disc(points: Points) -> NDArray[np.bool_]:
    """Failures in a circle of radius 0.3 around (0.4, 0.55): 28.3 % of the square."""
    return np.hypot(points[:, 0] - 0.4, points[:, 1] - 0.55) < 0.3


def known_of(rounds: list[Round], fails: Fails, judged: Fails | None = None) -> Known:
    points = np.concatenate([made.points for made in rounds]) if rounds else np.empty((0, 2))
    failed = fails(points).astype(np.float64)
    away = 1.0 / (1.0 + np.abs(np.hypot(points[:, 0] - 0.4, points[:, 1] - 0.55) - 0.3))
    severity = np.where(failed > 0.5, 1.0, 0.9 * away)
    if judged is not None:
        failed[~judged(points)] = np.nan
    return Known(points, failed, severity, np.zeros(len(points), dtype=np.bool_))


def searched(settings: Search, fails: Fails, judged: Fails | None = None, seed: int = 3) -> list[Round]:
    search, rounds = BoundarySearch(settings, 2, seed), list[Round]()
    for number in range(len(search.sizes)):
        rounds.append(search.propose(number, rounds, known_of(rounds, fails, judged)))
    return rounds


def wrong_share(points: Points, fails: Fails) -> float:
    """The share of the square on whose verdict the surrogate is wrong."""
    at = space_filling(4096, 2, 99)
    return float(((Surrogate(points, fails(points)).failing(at) > 0.5) != fails(at)).mean())


def test_a_search_knows_a_boundary_better_than_as_many_space_filling_drives() -> None:
    wrong, even = [], []
    for seed in range(3):
        found = np.concatenate([made.points for made in searched(Search(drives=40), disc, seed=seed)])
        assert len(found) == 40
        wrong.append(wrong_share(found, disc))
        even.append(wrong_share(space_filling(40, 2, seed), disc))
    assert np.mean(wrong) < 0.04
    assert np.mean(wrong) < 0.7 * np.mean(even)


def test_the_band_holds_the_boundary_and_shrinks_with_drives() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
    circle = np.column_stack([0.4 + 0.3 * np.cos(angles), 0.55 + 0.3 * np.sin(angles)])
    at = space_filling(4096, 2, 99)
    bands = []
    for drives in (40, 80):
        points = np.concatenate([made.points for made in searched(Search(drives=drives), disc)])
        surrogate = Surrogate(points, disc(points))
        side = surrogate.failing(circle)
        assert ((side > MAY) & (side < SURE)).mean() >= 0.85
        everywhere = surrogate.failing(at)
        bands.append(float(((everywhere > MAY) & (everywhere < SURE)).mean()))
    assert bands[0] < 0.4
    assert bands[1] < 0.5 * bands[0]


def test_proposals_repeat_by_their_seed_and_are_never_the_same_drive_twice() -> None:
    first, again = searched(Search(drives=30, batch=5), disc), searched(Search(drives=30, batch=5), disc)
    assert all(np.array_equal(one.points, other.points) for one, other in zip(first, again, strict=True))
    other = searched(Search(drives=30, batch=5), disc, seed=4)
    assert not np.array_equal(first[0].points, other[0].points)
    points = np.concatenate([made.points for made in first])
    apart = np.linalg.norm(points[:, None] - points[None], axis=2) + np.eye(len(points))
    assert apart.min() >= APART


def test_without_a_failure_a_search_goes_where_drives_are_severe() -> None:
    def speck(points: Points) -> NDArray[np.bool_]:
        return np.hypot(points[:, 0] - 0.4, points[:, 1] - 0.55) < 0.0

    rounds = searched(Search(drives=40, first=8, batch=8), speck)
    assert [made.about["by"] for made in rounds] == ["space-filling", *["severity"] * 4]
    led = np.concatenate([made.points for made in rounds[1:]])
    ring = np.abs(np.hypot(led[:, 0] - 0.4, led[:, 1] - 0.55) - 0.3)  # the most severe drives lie on the circle
    even = space_filling(32, 2, 3)
    assert np.median(ring) < np.median(np.abs(np.hypot(even[:, 0] - 0.4, even[:, 1] - 0.55) - 0.3))


def test_where_every_drive_comes_out_alike_a_search_fills_the_space() -> None:
    rounds = searched(Search(drives=20, first=8), lambda points: np.ones(len(points), dtype=np.bool_))
    assert {made.about["by"] for made in rounds} == {"space-filling"}


def test_a_search_avoids_places_where_drives_are_not_judged() -> None:
    def judged(points: Points) -> NDArray[np.bool_]:
        return points[:, 0] < 0.7

    later = np.concatenate([made.points for made in searched(Search(drives=48), disc, judged)[1:]])
    free = np.concatenate([made.points for made in searched(Search(drives=48), disc)[1:]])
    assert (~judged(later)).sum() <= (~judged(free)).sum() <= len(free)
    assert (~judged(later)).mean() < 0.2


@pytest.mark.parametrize(
    ("first", "drives", "batch", "sizes"),
    [(8, 24, 8, (8, 8, 8)), (10, 25, 8, (10, 8, 7)), (12, 12, 8, (12,)), (0, 20, 10, (10, 10))],
)
def test_rounds_have_all_drives(first: int, drives: int, batch: int, sizes: tuple[int, ...]) -> None:
    assert round_sizes(first, drives, batch) == sizes


@pytest.mark.parametrize("seed", range(6))
def test_few_failures_among_many_successes_are_not_taken_for_noise(seed: int) -> None:
    """A disc of 4.5 % of the square: every known failure lies on the failing side."""

    def small(points: Points) -> NDArray[np.bool_]:
        return np.hypot(points[:, 0] - 0.7, points[:, 1] - 0.3) < 0.12

    points = np.vstack([space_filling(25, 2, seed), [[0.7, 0.3]]])
    assert 1 <= small(points).sum() <= 4
    mean, _ = Surrogate(points, small(points)).latent(points[small(points)])
    assert (mean > 0.0).all()


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_failure_close_to_successes_keeps_its_side(dimensions: int, seed: int) -> None:
    failure = np.full(dimensions, 0.6)
    close = [failure + sign * APART * np.eye(dimensions)[axis] for axis in range(dimensions) for sign in (-2.0, 2.0)]
    points = np.vstack([space_filling(20, dimensions, seed), close, failure])
    failed = np.arange(len(points)) == len(points) - 1
    mean, _ = Surrogate(points, failed).latent(points)
    assert ((mean > 0.0) == failed).all()


def test_a_search_finds_more_failures_than_chance_where_it_was_not_tuned() -> None:
    """A disc of 4.5 % that each seed places elsewhere, with 26 drives."""
    region, found, chance = HELD_OUT["disc 4.5 %"], [], []
    for seed in range(8):
        gap = region.gap(seed)
        drives = drives_in(Search(drives=26, first=10, batch=4), region.dimensions, gap, seed, leads=True)
        found.append((gap(drives) < 0.0).sum())
        chance.append((gap(np.random.default_rng(seed).random((26, region.dimensions))) < 0.0).sum())
    assert np.mean(found) > 1.5 * np.mean(chance)
    assert np.count_nonzero(found) >= np.count_nonzero(chance)
