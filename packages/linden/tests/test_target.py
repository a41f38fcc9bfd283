"""The level of x86-64 that kernels are compiled for, chosen by the features of a processor."""

import numba
import pytest

from linden import target
from linden.target import LEVELS, choose, levels_of

V4, V3 = LEVELS


def features(*sets: frozenset[str], without: str = "") -> dict[str, bool]:
    """Return what LLVM tells of a processor with these features."""
    return {name: name != without for names in sets for name in names}


def test_a_processor_has_its_level_and_those_below() -> None:
    assert levels_of(features(V4.needs)) == [V4, V3]
    assert levels_of(features(V3.needs)) == [V3]


@pytest.mark.parametrize("without", sorted(V3.needs))
def test_a_level_needs_each_of_its_features(without: str) -> None:
    assert levels_of(features(V4.needs, without=without)) == []


def test_a_processor_below_all_levels_is_compiled_for_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "CPU_NAME", None)
    monkeypatch.setattr("llvmlite.binding.get_host_cpu_features", lambda: features(V3.needs, without="avx2"))
    assert choose() == "host"
    assert numba.config.CPU_NAME is None


def test_the_highest_level_is_set(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "CPU_NAME", None)
    monkeypatch.setattr(numba.config, "CPU_FEATURES", None)
    monkeypatch.setattr("llvmlite.binding.get_host_cpu_features", lambda: features(V3.needs))
    assert choose() == "x86-64-v3"
    assert numba.config.CPU_FEATURES == ""


def test_a_target_of_the_user_has_precedence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "CPU_NAME", "generic")
    assert target.choose() == "generic"
