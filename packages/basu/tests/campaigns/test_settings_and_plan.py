"""Claims about a campaign's file: it becomes jobs with stable ids, and a mistake in it is one sentence."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from basu.campaigns.campaign_run import RunSettings
from basu.campaigns.command import describe, player_settings
from basu.campaigns.planning import plan_of
from basu.campaigns.settings import checked, read_campaign
from basu.campaigns.shuffle import Shuffle
from basu.errors import UserError
from basu.scenarios.cases import open_library

Write = Callable[..., Path]


def test_jobs_are_the_product_with_agents_changing_fastest(campaign: Write) -> None:
    file = campaign()
    plan = plan_of(read_campaign(file), file)
    jobs = [plan.job(number) for number in range(plan.size)]
    assert plan.size == len(jobs) == 2 * 10 * 3
    assert [job["agent_name"] for job in jobs[:4]] == ["basic", "blind"] * 2
    assert len({job["identity"] for job in jobs[:20]}) == 10
    assert [job["seed"] for job in jobs[::20]] == [0, 1, 2]
    assert len({job["id"] for job in jobs}) == len(jobs)
    assert set(jobs[0]["parameters"]) == set(plan.parameters())


def test_a_job_has_the_same_id_in_another_campaign(campaign: Write) -> None:
    file = campaign()
    before = plan_of(read_campaign(file), file).job(0)
    file = campaign(("crossings", "others"), ("number = 3", "number = 1"), ("block = 8", "block = 5"))
    assert plan_of(read_campaign(file), file).job(0) == before
    file = campaign(more="\n[scoring]\ninfraction_weight = 0.5\n")
    assert plan_of(read_campaign(file), file).job(0)["id"] != before["id"]


def test_routes_weather_and_traffic_are_dimensions_too(campaign: Write) -> None:
    file = campaign(
        more='\n[[drives]]\nroutes = "routes/linden_short.xml"\nweather = ["ClearNoon", "HardRainNoon"]\n'
        "traffic = [{}, {vehicles = 20, walkers = 5}]\nseeds = {first = 7}\n"
    )
    plan = plan_of(read_campaign(file), file)
    routes = [plan.job(number) for number in range(60, plan.size)]
    found = {(job["weather"], job["vehicles"], job["walkers"], job["seed"]) for job in routes}
    assert found == {(weather, *others, 7) for weather in ("ClearNoon", "HardRainNoon") for others in ((0, 0), (20, 5))}
    assert {job["kind"] for job in routes} == {"route"}


def test_a_shuffled_campaign_has_the_same_jobs_in_another_order(campaign: Write) -> None:
    file = campaign()
    given = plan_of(read_campaign(file), file)
    file = campaign(('name = "crossings"', 'name = "crossings"\norder = "shuffled"'))
    shuffled = plan_of(read_campaign(file), file)
    ids = [[plan.job(number)["id"] for number in range(plan.size)] for plan in (given, shuffled)]
    assert ids[0] != ids[1]
    assert sorted(ids[0]) == sorted(ids[1])


@pytest.mark.parametrize("size", [1, 2, 3, 17, 256, 1000])
def test_a_shuffle_is_a_permutation(size: int) -> None:
    places = [Shuffle(size, 5)(place) for place in range(size)]
    assert sorted(places) == list(range(size))
    assert size < 10 or places != [Shuffle(size, 6)(place) for place in range(size)]


@pytest.mark.parametrize(
    ("before", "after", "sentence"),
    [
        pytest.param('"blind"', '"blnd"', "blnd", id="unknown agent"),
        pytest.param('"blind"', '"mine.py"', "there is no agent's file mine.py", id="no such file"),
        pytest.param('"blind"', '"human"', "a person drives", id="a person"),
        pytest.param('["basic", "blind"]', "[]", "agents is empty, so there is nothing to drive", id="empty product"),
        pytest.param("number = 3", "number = 0", "seeds.number is 0; write 1 or more", id="no seeds"),
        pytest.param("sweep = 10", "sweep = 10\nset = {early = 99}", "'early' is '99.0'; it must be a number from",
                     id="parameter out of range"),
        pytest.param('"speed"', '"spede"', "has no such parameter; did you mean 'speed'", id="unknown parameter"),
        pytest.param('"pedestrian_crossing_1"', '"nothing_1"', "there is no scenario 'nothing_1'", id="unknown case"),
        pytest.param("sweep = 10", "swep = 10", "drives.0.swep means nothing here; did you mean 'sweep'", id="key"),
        pytest.param("sweep = 10", "grid = 3\nsweep = 10", "two designs; choose one", id="two designs"),
        pytest.param("block = 8", 'block = "many"', "work.block is 'many'", id="type"),
        pytest.param('name = "crossings"', "", "name is missing", id="no name"),
        pytest.param('name = "crossings"', 'name = "a/b"', "name is 'a/b'", id="name of no folder"),
        pytest.param('name = "crossings"', 'name = "a', "is no TOML", id="no TOML"),
        pytest.param("number = 3}", 'number = 3}\nweather = ["Sunny"]', "no weather called 'Sunny'", id="weather"),
        pytest.param('cases = ["pedestrian_crossing_1"]\nsweep = 10\nvary = ["ahead", "speed"]',
                     'routes = "none.xml"', "route file 'none.xml' was not found", id="no route file"),
        pytest.param('cases = ["pedestrian_crossing_1"]\nsweep = 10\nvary = ["ahead", "speed"]',
                     'routes = "routes/linden_short.xml"\nroute_ids = ["99"]', "has no route '99'", id="no route"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_sentence(campaign: Write, before: str, after: str, sentence: str) -> None:
    file = campaign((before, after))
    with pytest.raises(UserError, match=sentence) as raised:
        plan_of(read_campaign(file), file)
    assert "\n" not in str(raised.value)


def test_a_file_of_scenarios_is_found_beside_the_campaign_and_workers_open_it(campaign: Write, tmp_path: Path) -> None:
    example = Path(__file__).parents[4] / "examples" / "scenarios" / "bin_lorry.py"
    for suffix in (".py", ".xml"):
        shutil.copy(example.with_suffix(suffix), tmp_path / f"lorry{suffix}")
    usual = 'cases = ["pedestrian_crossing_1"]\nsweep = 10\nvary = ["ahead", "speed"]'
    for word in ("lorry.xml", "lorry.py:BinLorry"):
        file = campaign((usual, f'cases = ["{word}"]'))
        plan = plan_of(read_campaign(file), file)
        library = open_library(plan.scenario_files)  # as a worker does it
        assert [len(library.of_id(plan.job(number)["identity"])) for number in range(plan.size)] == [1] * 6
    file = campaign((usual, 'cases = ["van.xml"]'))
    with pytest.raises(UserError, match=r"scenario file 'van\.xml' was not found"):
        plan_of(read_campaign(file), file)


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("seeds", 3, "seeds is 3; write a table with first, number"),
        ("name", "a b", "name is 'a b'; use letters, digits, '.', '_' and '-', and begin with a letter or digit"),
        ("agents", "basic", "agents is 'basic'; write a list in square brackets"),
        ("vehicle", 3, "vehicle is 3; write a text in quotation marks"),
        ("keep", {"failures": "many"}, "keep.failures is 'many'; write a whole number"),
        ("scoring", 3, "scoring is 3; write a table: {KEY = VALUE}"),
        ("name", "x" * 81, f"name is '{'x' * 81}'; use 80 characters at most"),
        ("order", "random", "order is 'random'; write 'given' or 'shuffled'"),
        ("tracks", {"basic": "all"}, "tracks.basic is 'all'; write 'world', 'objects' or 'sensors'"),
        ("confidence", 95, "confidence is 95; write a number below 1.0"),
        ("confidence", 0.5, "confidence is 0.5; write a number above 0.5"),
        ("step_limit_s", float("inf"), "step_limit_s is inf; write a finite number"),
        ("seeds", {"first": -1}, "seeds.first is -1; write 0 or more"),
        ("work", {"attempts": 11}, "work.attempts is 11; write 10 or less"),
        ("until", {}, "until.width is missing; give it a value"),
        (
            "drives",
            [{"cases": ["all"], "set": {"ahead": [1]}}],
            "drives.0.set.ahead is [1]; write a text in quotation marks or a number",
        ),
    ],
)
def test_a_value_of_the_wrong_kind_is_named_in_words_of_the_file(key: str, value: object, sentence: str) -> None:
    document = {"name": "x", "agents": ["basic"], "drives": [{"cases": ["all"]}], key: value}
    with pytest.raises(UserError) as caught:
        checked(document, "campaign.toml")
    assert str(caught.value) == f"campaign.toml: {sentence}"


def test_a_dry_run_warns_of_seeds_that_change_nothing(campaign: Write) -> None:
    assert "its 3 seeds change nothing in the world" in describe(campaign())
    assert "warning" not in describe(campaign(("number = 3", "number = 1")))


def test_an_open_campaign_is_another_campaign_and_is_marked(campaign: Write) -> None:
    file = campaign()
    usual = plan_of(read_campaign(file), file)
    file = campaign(('name = "crossings"', 'name = "crossings"\nopen = true'))
    plan = plan_of(read_campaign(file), file)
    assert {agent.group for agent in plan.agents} == {"world, NOT COMPARABLE: open"}
    assert plan.job(0)["id"] != usual.job(0)["id"]
    assert plan.identity()["the tracks"] != usual.identity()["the tracks"]
    settings = player_settings(plan, Path(), RunSettings(file=Path("campaign.toml"), output=Path()))
    assert settings.open
    assert not player_settings(usual, Path(), RunSettings(file=Path("campaign.toml"), output=Path())).open


def test_the_plan_names_the_track_of_each_agent(campaign: Write) -> None:
    file = campaign()
    usual = plan_of(read_campaign(file), file)
    assert [agent.track for agent in usual.agents] == ["world", "world"]
    file = campaign(('name = "crossings"', 'name = "crossings"\ntracks = {blind = "sensors"}'))
    plan = plan_of(read_campaign(file), file)
    assert [plan.job(number)["track"] for number in (0, 1)] == ["world", "sensors"]
    assert plan.job(0)["id"] == usual.job(0)["id"]
    assert plan.job(1)["id"] != usual.job(1)["id"]
    assert "blind (track sensors)" in describe(file)
    file = campaign(('name = "crossings"', 'name = "crossings"\ntracks = {nobody = "sensors"}'))
    with pytest.raises(UserError, match="none of the agents"):
        read_campaign(file)
