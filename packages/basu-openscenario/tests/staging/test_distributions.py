"""Claims about files with a distribution of parameters: a case for each run, by its seed, and what is refused."""

from pathlib import Path

import pytest

from basu.errors import ScenarioError
from basu.scenarios.cases import cases_of
from openscenario_texts import begins, scenario, vehicle, written

PARAMETERS = """<ParameterDeclaration name="speed" parameterType="double" value="10"><ConstraintGroup>
  <ValueConstraint rule="greaterOrEqual" value="0"/><ValueConstraint rule="lessOrEqual" value="20"/>
</ConstraintGroup></ParameterDeclaration>
<ParameterDeclaration name="at" parameterType="integer" value="120"/>
<ParameterDeclaration name="model" parameterType="string" value="car"/>"""
FILE = """<OpenSCENARIO><FileHeader revMajor="1" revMinor="2" date="2026-01-01T00:00:00" description="" author=""/>
<ParameterValueDistribution><ScenarioFile filepath="{file}"/>{inside}</ParameterValueDistribution></OpenSCENARIO>"""
WEIGHED = '<Element value="4" weight="1"/><Element value="8" weight="3"/>'
RANGE = '<Range lowerLimit="4" upperLimit="12"/>'


def single(name: str, inside: str) -> str:
    return (
        f'<DeterministicSingleParameterDistribution parameterName="{name}">{inside}'
        "</DeterministicSingleParameterDistribution>"
    )


def drawn(inside: str, *, runs: int = 500, seed: int = 1, name: str = "speed") -> str:
    one = f'<StochasticDistribution parameterName="{name}">{inside}</StochasticDistribution>'
    return f'<Stochastic numberOfTestRuns="{runs}" randomSeed="{seed}">{one}</Stochastic>'


def values(folder: Path, inside: str, *, file: str = "test.xosc") -> list[dict[str, object]]:
    """Return the values of the cases of a distribution over a file with three parameters."""
    text = scenario(
        entities=vehicle("Other", "$model") + vehicle("Ego"),
        init=begins("Other", "$at", "$speed") + begins("Ego", 50, 10),
        stop=0.5,  # each case is played once to its end
        parameters=PARAMETERS,
    )
    written(folder, text)
    path = folder / "many.xosc"
    path.write_text(FILE.format(file=file, inside=inside), encoding="utf-8")
    return [{**one.values, "name": one.case.name} for one in cases_of([str(path)])]


def speeds(folder: Path, inside: str) -> list[float]:
    return [float(one["speed"]) for one in values(folder, inside)]  # type: ignore[arg-type]


@pytest.mark.usefixtures("plugin")
def test_deterministic_distributions_give_all_combinations(tmp_path: Path) -> None:
    steps = single(
        "speed", '<DistributionRange stepWidth="0.1"><Range lowerLimit="4" upperLimit="4.3"/></DistributionRange>'
    )
    words = single("model", '<DistributionSet><Element value="van"/><Element value="bus"/></DistributionSet>')
    found = values(tmp_path, f"<Deterministic>{steps}{words}</Deterministic>")
    assert [(one["speed"], one["model"]) for one in found] == [
        (speed, model) for speed in (4.0, 4.1, 4.2, 4.3) for model in ("van", "bus")
    ]
    assert [one["name"] for one in found][:2] == ["many-1", "many-2"]
    assert {one["at"] for one in found} == {120.0}


@pytest.mark.usefixtures("plugin")
def test_parameters_of_a_set_change_together(tmp_path: Path) -> None:
    sets = "".join(
        f'<ParameterValueSet><ParameterAssignment parameterRef="speed" value="{speed}"/>'
        f'<ParameterAssignment parameterRef="at" value="{at}"/></ParameterValueSet>'
        for speed, at in ((5, 100), (7, 130))
    )
    inside = f"<ValueSetDistribution>{sets}</ValueSetDistribution>"
    multi = f"<DeterministicMultiParameterDistribution>{inside}</DeterministicMultiParameterDistribution>"
    found = values(tmp_path, f"<Deterministic>{multi}</Deterministic>")
    assert [(one["speed"], one["at"]) for one in found] == [(5.0, 100.0), (7.0, 130.0)]


@pytest.mark.usefixtures("plugin")
@pytest.mark.parametrize(
    ("inside", "mean", "variance"),
    [
        ('<NormalDistribution expectedValue="8" variance="1"/>', 8.0, 1.0),
        ('<LogNormalDistribution expectedValue="8" variance="2"/>', 8.0, 2.0),
        (f"<UniformDistribution>{RANGE}</UniformDistribution>", 8.0, 64.0 / 12.0),
        (
            '<PoissonDistribution expectedValue="6"><Range lowerLimit="0" upperLimit="20"/></PoissonDistribution>',
            6.0,
            6.0,
        ),
        (
            f"<ProbabilityDistributionSet>{WEIGHED}</ProbabilityDistributionSet>",
            7.0,
            3.0,
        ),
        (f'<Histogram><Bin weight="2">{RANGE}</Bin></Histogram>', 8.0, 64.0 / 12.0),
    ],
)
def test_draws_have_the_moments_of_their_distribution(
    tmp_path: Path, inside: str, mean: float, variance: float
) -> None:
    found = speeds(tmp_path, drawn(inside))
    average = sum(found) / len(found)
    assert average == pytest.approx(mean, abs=4.0 * (variance / 500.0) ** 0.5)
    assert sum((one - average) ** 2 for one in found) / 499.0 == pytest.approx(variance, rel=0.25)


@pytest.mark.usefixtures("plugin")
def test_the_same_seed_gives_the_same_draws(tmp_path: Path) -> None:
    normal = f'<NormalDistribution expectedValue="8" variance="4">{RANGE}</NormalDistribution>'
    first, again, other = (speeds(tmp_path, drawn(normal, runs=50, seed=seed)) for seed in (1, 1, 2))
    assert first == again != other
    assert all(4.0 <= one <= 12.0 for one in first)


@pytest.mark.usefixtures("plugin")
@pytest.mark.parametrize(
    ("inside", "sentence"),
    [
        ("<Deterministic/>", "has 0 runs"),
        (drawn('<UserDefinedDistribution type="x"/>'), "<UserDefinedDistribution> is not supported"),
        (drawn(f"<UniformDistribution>{RANGE}</UniformDistribution>", runs=0), "has 0 runs; give 1 to 10000"),
        (drawn(f"<UniformDistribution>{RANGE}</UniformDistribution>", name="sped"), "declares no parameter 'sped'"),
        (drawn('<NormalDistribution expectedValue="8" variance="-1"/>'), "is impossible"),
        (drawn('<PoissonDistribution expectedValue="30"/>', runs=5), "allow none of the 5 runs"),
        (
            drawn(f'<NormalDistribution expectedValue="90" variance="1">{RANGE}</NormalDistribution>'),
            "none of 10000 draws lies from 4 to 12",
        ),
        (
            single("speed", f'<DistributionRange stepWidth="0">{RANGE}</DistributionRange>').join(
                ("<Deterministic>", "</Deterministic>")
            ),
            "are too many",
        ),
    ],
)
def test_bad_distributions_are_refused_with_a_sentence(tmp_path: Path, inside: str, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        values(tmp_path, inside)


@pytest.mark.usefixtures("plugin")
def test_a_missing_scenario_is_named_with_its_line(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"many\.xosc:2: the scenario .*gone\.xosc does not exist"):
        values(tmp_path, drawn(f"<UniformDistribution>{RANGE}</UniformDistribution>"), file="gone.xosc")


@pytest.mark.usefixtures("plugin")
def test_runs_outside_the_constraints_are_left_out_and_counted(tmp_path: Path) -> None:
    speeds_in_file = "".join(f'<Element value="{value}"/>' for value in (-5, 5, 25))
    one = single("speed", f"<DistributionSet>{speeds_in_file}</DistributionSet>")
    assert [found["speed"] for found in values(tmp_path, f"<Deterministic>{one}</Deterministic>")] == [5.0]
    (playable,) = cases_of([str(tmp_path / "many.xosc")])
    assert "2 of 3 runs are left out" in (playable.scenario.__doc__ or "")


@pytest.mark.usefixtures("plugin")
def test_a_distribution_without_a_run_inside_the_constraints_is_refused(tmp_path: Path) -> None:
    one = single("speed", '<DistributionSet><Element value="-5"/></DistributionSet>')
    with pytest.raises(ScenarioError, match=r"many\.xosc: the constraints of .* allow none of the 1 runs"):
        values(tmp_path, f"<Deterministic>{one}</Deterministic>")


@pytest.mark.usefixtures("plugin")
def test_a_distribution_of_itself_is_refused(tmp_path: Path) -> None:
    one = single("speed", '<DistributionSet><Element value="5"/></DistributionSet>')
    with pytest.raises(ScenarioError, match=r"many\.xosc:1: .* no storyboard"):
        values(tmp_path, f"<Deterministic>{one}</Deterministic>", file="many.xosc")
