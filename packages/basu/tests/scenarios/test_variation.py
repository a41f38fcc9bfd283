"""Claims about variants: an id alone gives the same case again, has one spelling, and wrong ones get sentences."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from basu.errors import ScenarioError
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.sampling import Grid, Sweep
from basu.scenarios.stage import Pose
from basu.scenarios.variation import Variation, parse_id, variant, variants
from basu.scenarios.xml_elements import Case, GivenActor

PARAMETERS = (
    Number("speed", 5.0, 2.0, 10.0, "m/s", "of the leader"),
    Number("gap", 1.0, 0.5, 2.0, "s", "before it brakes"),
    Choice("kind", ("car", "motorcycle", "bicycle"), "the leader"),
)
CASE = Case(
    name="leader_1",
    type="Leader",
    town="Linden",
    ego=GivenActor(role="hero", model="vehicle.*", pose=Pose(0.0, 0.0)),
    values={"gap": "1.5"},
)
NAMES = [parameter.name for parameter in PARAMETERS]


@st.composite
def variations(draw: st.DrawFn) -> Variation:
    names = draw(st.permutations(NAMES))
    cut = draw(st.integers(0, 2))
    texts = {"speed": "6.25", "gap": "0.5", "kind": "bicycle"}
    design = draw(
        st.one_of(
            st.none(), st.builds(Sweep, st.integers(1, 40), st.integers(0, 99)), st.builds(Grid, st.integers(2, 4))
        )
    )
    vary = tuple(names[cut : cut + draw(st.integers(0, 3))]) if design else ()
    return Variation(fixed=tuple((name, texts[name]) for name in names[:cut]), design=design, vary=vary)


@given(variation=variations())
def test_every_variant_is_made_again_from_its_id_alone(variation: Variation) -> None:
    made = variants(CASE, PARAMETERS, variation)
    assert len({case.name for case in made}) == len(made)
    for case in made:
        assert parse_id(case.name)[0] == CASE.name
        assert variant(CASE, PARAMETERS, case.name) == case


def test_a_sweep_changes_all_parameters_but_the_fixed_ones() -> None:
    made = variants(CASE, PARAMETERS, Variation(fixed=(("speed", "6.0"),), design=Sweep(3, 7)))
    assert [case.name for case in made] == [f"leader_1:speed=6:sweep-3-7-{index}" for index in (1, 2, 3)]
    assert {case.values["speed"] for case in made} == {"6"}
    assert len({case.values["gap"] for case in made}) == 3


def test_what_is_not_varied_is_as_the_file_has_it() -> None:
    made = variants(CASE, PARAMETERS, Variation(design=Grid(2), vary=("kind", "speed")))
    assert [case.name for case in made][:2] == ["leader_1:grid-2-1:speed,kind", "leader_1:grid-2-2:speed,kind"]
    assert {case.values["gap"] for case in made} == {"1.5"}
    assert [case.values["speed"] for case in made] == ["2", "2", "2", "10", "10", "10"]


def test_values_that_are_set_alone_make_one_case() -> None:
    (case,) = variants(CASE, PARAMETERS, Variation(fixed=(("kind", "bicycle"), ("gap", "2"))))
    assert case.name == "leader_1:gap=2,kind=bicycle"
    assert case.values == {"gap": "2", "kind": "bicycle"}
    assert variants(CASE, PARAMETERS, Variation()) == (CASE,)


@pytest.mark.parametrize(
    ("variation", "sentence"),
    [
        (Variation(fixed=(("sped", "5"),)), "--set sped=5: there is no such parameter; did you mean 'speed'"),
        (Variation(fixed=(("speed", "50"),)), "'speed' is '50'; it must be a number from 2 to 10 m/s"),
        (Variation(fixed=(("speed", "5"), ("speed", "6"))), "--set speed is given twice"),
        (Variation(vary=("speed",)), "--vary speed says what to change, not how; add --sweep or --grid"),
        (Variation(vary=("sped",), design=Grid(2)), "--vary sped: Leader has no such parameter; did you mean 'speed'"),
        (Variation(vary=("gap", "gap"), design=Grid(2)), "--vary gap: it is named already"),
        (Variation(vary=("gap",), fixed=(("gap", "1"),), design=Grid(2)), "--vary gap: it is set already"),
        (Variation(design=Grid(80)), "grid of 3 parameters .* has 19,200 cases"),
    ],
)
def test_a_variation_that_cannot_be_made_gets_a_sentence(variation: Variation, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        variants(CASE, PARAMETERS, variation)


def test_a_scenario_without_parameters_cannot_be_swept() -> None:
    with pytest.raises(ScenarioError, match="leader_1: Leader has no parameter left to change; drive it as it is"):
        variants(CASE, (), Variation(design=Sweep(5, 0)))


@pytest.mark.parametrize(
    ("identity", "sentence"),
    [
        ("leader_1:sweep-3-7", "cannot be read at 'sweep-3-7'; an id is CASE"),
        ("leader_1:sweep-3-7-0", "cannot be read at 'sweep-3-7-0'"),
        ("leader_1:sweep-3-7-4", "asks for number 4 of 3; the last is leader_1:sweep-3-7-3"),
        ("leader_1:grid-2-1:gap:speed", "cannot be read at 'grid-2-1:gap:speed'"),
        ("leader_1:grid-2-1:gop", "did you mean 'gap'"),
        ("leader_1:gap", "cannot be read at 'gap'"),
    ],
)
def test_an_id_that_means_nothing_gets_a_sentence(identity: str, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        variant(CASE, PARAMETERS, identity)
