"""Claims about finding scenarios: by type, group, id and file; a user's beside BASU's; sentences for the rest."""

from pathlib import Path

import pytest

from basu.errors import ScenarioError
from basu.scenarios import cases as library
from basu.scenarios.cases import by_id, cases_of, open_library, snake, varied
from basu.scenarios.sampling import Sweep
from basu.scenarios.variation import Variation

CLASSES = """
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import Choice, Number
from basu.scenarios.scenario import Scenario
from basu.scenarios.triggers import EgoArrives

class Falling(Scenario):
    group = Group.ANIMAL
    def trigger(self): return EgoArrives()
    def conflict(self): return EgoArrives()
    def criteria(self): return []

class FallingTree(Falling):
    '''A tree falls.

    More of it.
    '''
    aliases = ("TheirTree",)
    parameters = (Number("ahead", 40, 20, 80, "m", "of the trigger point"), Choice("side", ("left", "right"), "of it"))

class FallingRock(FallingTree):
    '''A rock falls.'''
    aliases = ()
"""
CASE = '<scenario name="{name}" type="{type}" town="Linden"><ego_vehicle x="1" y="2" yaw="0"/>{inside}</scenario>'


def cases_xml(*cases: tuple[str, str, str]) -> str:
    inside = "\n".join(CASE.format(name=name, type=type_, inside=inside) for name, type_, inside in cases)
    return f"<scenarios>\n{inside}\n</scenarios>"


@pytest.fixture(name="mine")
def mine_(tmp_path: Path) -> Path:
    """A user's pair of files; its XML."""
    (tmp_path / "mine.py").write_text(CLASSES)
    path = tmp_path / "mine.xml"
    path.write_text(
        cases_xml(
            ("tree_1", "FallingTree", '<ahead value="30"/>'),
            ("tree_2", "FallingTree", ""),
            ("rock_1", "FallingRock", ""),
        )
    )
    return path


def names(wanted: str | list[str], *files: Path) -> list[str]:
    return [playable.case.name for playable in cases_of(wanted, files)]


def test_every_packaged_case_can_be_played_and_lies_in_its_types_file() -> None:
    chosen = cases_of("all")
    for playable in chosen:
        file = Path(playable.case.source.rpartition(", line ")[0])
        assert file.stem == snake(playable.scenario.__name__)
        assert playable.case.type == playable.scenario.__name__
        assert playable.case.name.startswith(file.stem + "_")
    assert len({playable.case.name for playable in chosen}) == len(chosen)


def test_no_two_scenarios_answer_to_one_name() -> None:
    known = [name for scenario in open_library().scenarios for name in (scenario.__name__, *scenario.aliases)]
    assert len(set(known)) == len(known)


def test_a_file_brings_the_classes_beside_it_and_the_classes_the_cases(mine: Path) -> None:
    assert names(str(mine)) == ["tree_1", "tree_2", "rock_1"]
    assert names(str(mine.with_suffix(".py"))) == ["tree_1", "tree_2", "rock_1"]
    assert names("tree_2", mine.with_suffix(".py")) == ["tree_2"]


def test_a_class_behind_a_colon_has_only_its_cases(mine: Path) -> None:
    assert names(f"{mine.with_suffix('.py')}:FallingRock") == ["rock_1"]
    with pytest.raises(ScenarioError, match=r"mine\.xml has no case of type FallingLeaf"):
        names(f"{mine.with_suffix('.py')}:FallingLeaf")


@pytest.mark.parametrize("spelling", ["FallingTree", "falling_tree", "falling-tree", "Falling Tree", "fallingtree"])
def test_a_type_may_be_spelt_as_people_do(mine: Path, spelling: str) -> None:
    assert names(spelling, mine) == ["tree_1", "tree_2"]


def test_a_group_has_the_cases_of_all_its_types(mine: Path) -> None:
    found = names("animal", mine)
    assert set(found) >= {"tree_1", "tree_2", "rock_1"}
    assert found == names("group:animal", mine)


def test_a_case_that_is_meant_twice_is_played_once(mine: Path) -> None:
    assert names(["rock_1", "falling_rock", str(mine)]) == ["rock_1", "tree_1", "tree_2"]


def test_a_class_takes_its_values_from_the_case_and_its_defaults(mine: Path) -> None:
    assert [playable.values for playable in cases_of("falling_tree", [mine])] == [
        {"ahead": 30.0, "side": "left"},
        {"ahead": 40.0, "side": "left"},
    ]


def test_the_base_of_others_is_no_scenario(mine: Path) -> None:
    assert "Falling" not in [scenario.__name__ for scenario in open_library([mine]).scenarios]


def test_a_title_is_the_first_line_of_the_docstring(mine: Path) -> None:
    assert cases_of("tree_1", [mine])[0].scenario.title() == "A tree falls."


def test_a_sampled_case_is_found_again_by_its_id_alone(mine: Path) -> None:
    sampled = varied(cases_of("falling_tree", [mine]), Variation(design=Sweep(5, 3)))
    assert len(sampled) == 10
    for playable in sampled:
        again = by_id(playable.case.name, [mine])
        assert (again.case, again.values) == (playable.case, playable.values)
        assert names(playable.case.name, mine) == [playable.case.name]


def test_a_case_is_sampled_within_what_it_leaves_of_its_parameters(tmp_path: Path, mine: Path) -> None:
    limits = '<ahead value="50" low="45" high="60"/><side among="right"/>'
    (tmp_path / "mine.xml").write_text(cases_xml(("tree_1", "FallingTree", limits)))
    sampled = varied(cases_of("tree_1", [mine]), Variation(design=Sweep(20, 3)))
    aheads = [each.values["ahead"] for each in sampled]
    assert 45.0 < min(aheads) < 46.0
    assert 59.0 < max(aheads) < 60.0
    assert {each.values["side"] for each in sampled} == {"right"}
    assert by_id(sampled[7].case.name, [mine]).values == sampled[7].values
    with pytest.raises(ScenarioError, match="'ahead' is '30'; it must be a number from 45 to 60 m"):
        by_id("tree_1:ahead=30", [mine])


def test_an_alias_reads_scenario_runners_file_and_leaves_alone_what_only_its_class_reads(
    tmp_path: Path, mine: Path
) -> None:
    theirs = tmp_path / "theirs.xml"
    inside = '<ahead value="25"/><source_dist_interval from="20" to="50"/><start_actor_flow x="1" y="2" z="0"/>'
    theirs.write_text(cases_xml(("TheirTree_1", "TheirTree", inside)))
    (playable,) = cases_of(str(theirs), [mine])
    assert playable.scenario.__name__ == "FallingTree"
    assert playable.values["ahead"] == 25.0
    assert playable.unread == (
        "source_dist_interval_from",
        "source_dist_interval_to",
        "start_actor_flow_x",
        "start_actor_flow_y",
        "start_actor_flow_z",
    )


def test_the_place_of_another_actor_is_listed_as_unread_by_a_class_of_basu(tmp_path: Path) -> None:
    theirs = tmp_path / "theirs.xml"
    other = '<other_actor x="5" y="6" yaw="0" model="vehicle.audi.tt"/>'
    theirs.write_text(cases_xml(("a_1", "FollowLeadingVehicle", other), ("a_2", "FollowLeadingVehicle", "")))
    first, second = cases_of(str(theirs))
    assert (first.unread, second.unread) == (("place of other_actor",), ())


def test_a_speed_of_scenario_runners_class_is_not_taken_for_one_of_ours(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(
        CLASSES.replace('Number("ahead", 40, 20, 80, "m"', 'Number("speed", 4, 2, 8, "m/s"')
    )
    inside = '<speed value="60"/>'
    (tmp_path / "mine.xml").write_text(cases_xml(("a_1", "TheirTree", inside), ("a_2", "FallingTree", inside)))
    (playable,) = cases_of("a_1", [tmp_path / "mine.xml"])
    assert (playable.values["speed"], playable.unread) == (4.0, ("speed",))
    with pytest.raises(ScenarioError, match="'speed' is '60'; it must be a number from 2 to 8 m/s"):
        cases_of("a_2", [tmp_path / "mine.xml"])


@pytest.mark.parametrize(
    ("case", "sentence"),
    [
        (
            ("a_1", "FallingTre", ""),
            r"bad\.xml, line 2: 'a_1' is of type 'FallingTre', which .*did you mean 'FallingTree'",
        ),
        (("a_1", "Zzz", ""), r"'Zzz', which there is not; `basu scenario list` shows them; a class of your own"),
        (("a_1", "FallingTree", '<ahed value="30"/>'), "of type FallingTree: it has no parameter 'ahed'; .*'ahead'"),
        (("a_1", "FallingTree", '<ahead value="90"/>'), "'ahead' is '90'; it must be a number from 20 to 80 m"),
        (("a_1", "FallingTree", '<ahead value="far"/>'), "'ahead' is 'far'; it must be a number"),
        (("a_1", "FallingTree", '<side value="up"/>'), "'side' is 'up'; it must be one of left, right"),
        (("a_1", "FallingTree", '<gap value="2"/>'), "it has no parameter 'gap'; it has ahead, side"),
    ],
)
def test_a_case_that_its_class_cannot_play_gets_a_sentence(
    tmp_path: Path, mine: Path, case: tuple[str, str, str], sentence: str
) -> None:
    bad = tmp_path / "bad.xml"
    bad.write_text(cases_xml(case))
    with pytest.raises(ScenarioError, match=sentence):
        names(str(bad), mine)


@pytest.mark.parametrize(
    ("wanted", "sentence"),
    [
        ("tree_3", "there is no scenario 'tree_3'; did you mean 'tree_"),
        ("falling_rocks", "did you mean 'falling_rock'"),
        ("pedestrain", "did you mean 'pedestrian'"),
        (
            "zzzzzz",
            "it may be a case, a type, a group, a suite, FILE.xml or all, and one of yours with --scenarios FILE",
        ),
        ("tree_1:ahead=90", "'ahead' is '90'; it must be a number from 20 to 80 m"),
        ("none.xml", r"none\.xml cannot be read"),
        ("none.py", r"none\.py does not exist"),
    ],
)
def test_a_word_that_means_nothing_gets_a_sentence(mine: Path, wanted: str, sentence: str) -> None:
    with pytest.raises(ScenarioError, match=sentence):
        names(wanted, mine)


def test_an_id_that_no_case_has_is_reported() -> None:
    with pytest.raises(ScenarioError, match="there is no case 'nobody_1:sweep-5-1-1'"):
        by_id("nobody_1:sweep-5-1-1")


def test_two_files_with_a_case_of_one_name_are_reported_only_when_it_matters(tmp_path: Path, mine: Path) -> None:
    other = tmp_path / "other.xml"
    other.write_text(cases_xml(("tree_1", "FallingTree", "")))
    assert names(str(other), mine) == ["tree_1"]
    for wanted in ("tree_1", "falling_tree"):
        with pytest.raises(
            ScenarioError, match=r"'tree_1' is given in .*mine\.xml, line 2 and in .*other\.xml, line 2"
        ):
            names(wanted, mine, other)


def test_a_users_class_may_not_take_a_name_that_is_known(tmp_path: Path, mine: Path) -> None:
    (tmp_path / "again.py").write_text(CLASSES.replace("FallingTree", "Falling_tree"))
    with pytest.raises(ScenarioError, match=r"again\.py has a scenario Falling_tree, and .*name yours otherwise"):
        names("all", mine, tmp_path / "again.py")


def test_a_file_of_another_kind_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"--scenarios mine\.json: name a FILE\.py with classes or a FILE\.xml"):
        names("all", Path("mine.json"))


def test_a_type_without_cases_says_so(tmp_path: Path) -> None:
    (tmp_path / "lonely.py").write_text(CLASSES)
    with pytest.raises(ScenarioError, match="FallingTree has no case; name an XML file that has one"):
        names("falling_tree", tmp_path / "lonely.py")


@pytest.mark.parametrize(("name", "told"), [("FollowLeadingVehicle", "follow_leading_vehicle"), ("CutIn", "cut_in")])
def test_ids_are_in_snake_case(name: str, told: str) -> None:
    assert snake(name) == told


def test_all_is_bounded_by_what_is_packaged(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, mine: Path) -> None:
    monkeypatch.setattr(library, "LIBRARY", tmp_path / "nothing")
    assert names("all", mine) == ["tree_1", "tree_2", "rock_1"]


@pytest.mark.parametrize(
    ("identity", "type_name"),
    [
        ("LindenFollowLeadingVehicle_1", "FollowLeadingVehicle"),
        ("LindenFollowLeadingVehicleWithObstacle_1", "FollowLeadingVehicleWithObstacle"),
        ("LindenControlLoss_1", "ControlLoss"),
        ("LindenDynamicObjectCrossing_2", "DynamicObject"),
        ("LindenOppositeVehicleRunningRedLight_1", "RedLightRunner"),
        ("LindenOppositeVehicleTakingPriority_1", "StopSignRunner"),
    ],
)
def test_the_file_that_scenario_runner_plays_is_read_as_it_is(identity: str, type_name: str) -> None:
    theirs = Path(__file__).parents[4] / "examples" / "scenario_runner" / "linden.xml"
    (playable,) = cases_of(identity, [theirs])
    assert playable.scenario.__name__ == type_name
    assert playable.case.ego.model == "vehicle.lincoln.mkz_2017"
