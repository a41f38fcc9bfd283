"""Path loss against figures that were reckoned another way: by hand, with complex numbers, from published curves."""

import cmath
import math

import pytest

from linden.sensors.devices.radio.path_loss import (
    LIGHT_MPS,
    Edge,
    Path,
    PathState,
    edge_loss_db,
    fading_db,
    path_loss_db,
    two_ray_db,
)
from linden.sensors.devices.radio.spec import ChannelSpec, PathLossModel, Scenario

WAVELENGTH_M = LIGHT_MPS / 5.9e9
FREE = Path(100.0, 1.5, 1.5)
BLOCKED = FREE._replace(state=PathState.BUILDINGS)


def channel(**changed: object) -> ChannelSpec:
    return ChannelSpec(etsi_fading=False)._replace(**changed)


@pytest.mark.parametrize(
    ("scenario", "path", "loss_db"),
    [
        (Scenario.HIGHWAY, FREE, 87.817),  # 32.4 + 20 · 2 + 20 · 0.77085
        (Scenario.RURAL, FREE, 86.200),  # 38.77 + 16.7 · 2 + 18.2 · 0.77085
        (Scenario.URBAN, FREE, 86.200),
        (Scenario.HIGHWAY, BLOCKED, 111.419),  # 36.85 + 30 · 2 + 18.9 · 0.77085
        (Scenario.URBAN, BLOCKED, 111.419),
    ],
)
def test_winner(scenario: Scenario, path: Path, loss_db: float) -> None:
    assert path_loss_db(channel(scenario=scenario), path) == pytest.approx(loss_db, abs=2e-3)


def test_two_rays_are_the_sum_of_two_waves() -> None:
    high_m, low_m, permittivity = 3.0, 1.5, 1.02
    for across_m in (5.0, 20.0, 81.0, 300.0):
        direct_m = abs(complex(across_m, high_m - low_m))
        reflected_m = abs(complex(across_m, high_m + low_m))
        grazing = math.atan2(high_m + low_m, across_m)
        root = cmath.sqrt(permittivity - math.cos(grazing) ** 2)
        reflection = (math.sin(grazing) - root) / (math.sin(grazing) + root)
        wave = 1.0 + reflection * cmath.exp(2j * math.pi * (direct_m - reflected_m) / WAVELENGTH_M)
        expected_db = -20.0 * math.log10(WAVELENGTH_M / (4.0 * math.pi * across_m) * abs(wave))
        assert two_ray_db(direct_m, high_m, low_m, WAVELENGTH_M) == pytest.approx(expected_db, abs=1e-9)


def test_far_away_two_rays_weaken_with_the_fourth_power() -> None:
    near_db, far_db = (two_ray_db(distance_m, 1.5, 1.5, WAVELENGTH_M) for distance_m in (2e5, 2e6))
    assert far_db - near_db == pytest.approx(40.0, abs=0.1)


def test_a_geometric_channel_behind_a_house_has_the_exponent_asked_for() -> None:
    spec = channel(model=PathLossModel.GEOMETRIC, path_loss_exponent=3.0, reference_distance_m=10.0)
    at_10_m = 20.0 * math.log10(4.0 * math.pi * 10.0 / WAVELENGTH_M)
    assert path_loss_db(spec, BLOCKED) == pytest.approx(at_10_m + 30.0)


@pytest.mark.parametrize(("v", "loss_db"), [(-0.8, 0.0), (0.0, 6.03), (1.0, 13.93), (2.4, 20.54)])
def test_a_knife_edge_costs_what_itu_draws(v: float, loss_db: float) -> None:
    """Recommendation ITU-R P.526, figure 9, and its approximation there."""
    height_m = v / math.sqrt(2.0 * 40.0 / (WAVELENGTH_M * 20.0 * 20.0))
    assert edge_loss_db(Edge(20.0, 20.0, height_m), WAVELENGTH_M) == pytest.approx(loss_db, abs=0.05)


def test_the_worst_of_several_roofs_counts() -> None:
    roofs = [Edge(30.0, 70.0, 0.0), Edge(60.0, 40.0, 1.2), Edge(50.0, 50.0, -0.3)]
    path = FREE._replace(state=PathState.VEHICLES, edges=roofs)
    worst_db = edge_loss_db(roofs[1], WAVELENGTH_M)
    assert worst_db > 15.0
    assert path_loss_db(channel(), path) == pytest.approx(path_loss_db(channel(), FREE) + worst_db)
    geometric = path_loss_db(channel(model=PathLossModel.GEOMETRIC), path)
    assert geometric == pytest.approx(20.0 * math.log10(4.0 * math.pi * 100.0 / WAVELENGTH_M) + worst_db)


def test_fading_follows_etsi_or_the_user() -> None:
    etsi = ChannelSpec(scenario=Scenario.URBAN)
    assert [fading_db(etsi, state) for state in PathState] == [5.2, 5.3, 6.8]
    assert fading_db(channel(custom_fading_db=2.0), PathState.BUILDINGS) == 2.0


@pytest.mark.parametrize("model", PathLossModel)
@pytest.mark.parametrize("state", PathState)
def test_antennas_in_one_place_or_on_the_road_have_a_finite_loss(model: PathLossModel, state: PathState) -> None:
    edges = [Edge(0.0, 0.0, 1.0)] if state is PathState.VEHICLES else []
    for distance_m in (0.0, 50.0):
        assert math.isfinite(path_loss_db(channel(model=model), Path(distance_m, 0.0, 0.0, state, edges)))
