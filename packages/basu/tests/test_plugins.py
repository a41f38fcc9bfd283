"""Claims about plugins: what entry points name is found, and what is missing is named with its ``pip install``."""

from collections.abc import Iterator
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from basu import plugins
from basu.agents.loader import load_agent, names
from basu.campaigns.search_part import search_plugin
from basu.cli import main
from basu.errors import UserError
from basu.options.run import RunOptions
from basu.running.outputs import check_outputs
from basu.running.preparation import prepare
from basu.scenarios.cases import open_library

STRANGER = """
from basu.agents.autonomous_agent import AutonomousAgent
from basu.plugins import Command
from basu.scenarios.case_xml import read_cases
from basu.scenarios.cases import ScenarioFile

class Timid(AutonomousAgent):
    def setup(self): ...
    def run_step(self, sensor_data): ...
    def config(self): return {"routes": "routes/linden_short.xml"}

def add_towns(parser):
    parser.add_argument("word")
    parser.set_defaults(command=lambda arguments: print(f"towns {arguments.word}") or 0)

TOWNS = Command("list towns", add_towns)
CHECKED = []

def read(path):
    return ScenarioFile([], read_cases(path))

class Speeds:
    def check(self, options): CHECKED.append(options.agent)
    def managers(self, options, drive): return [drive.agent]

OUTPUT = Speeds()
"""


@pytest.fixture
def only(monkeypatch: pytest.MonkeyPatch) -> Iterator[dict[str, dict[str, str]]]:
    """Entry points as if these alone were installed: group -> name -> place."""
    installed: dict[str, dict[str, str]] = {}

    def found(*, group: str) -> list[EntryPoint]:
        return [EntryPoint(name, place, group) for name, place in installed.get(group, {}).items()]

    monkeypatch.setattr(plugins, "entry_points", found)
    plugins.offered.cache_clear()
    yield installed
    plugins.offered.cache_clear()


@pytest.fixture
def stranger(only: dict[str, dict[str, str]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install the plugin of another project, and none of this one's."""
    (tmp_path / "stranger.py").write_text(STRANGER, "utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    only[plugins.COMMANDS] = {"towns": "stranger:TOWNS"}
    only[plugins.AGENTS] = {"timid": "stranger:Timid"}
    only[plugins.SCENARIO_FILES] = {"cases": "stranger:read"}
    only[plugins.OUTPUTS] = {"speeds": "stranger:OUTPUT"}


@pytest.mark.usefixtures("only")
@pytest.mark.parametrize("command", ["metrics", "replay", "ros", "serve", "sumo", "truth", "watch"])
def test_a_command_without_its_plugin_names_what_to_install(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([command, "--help"]) == 2
    distribution = plugins.DISTRIBUTIONS[plugins.COMMANDS][command]
    wanted = f"basu: `basu {command}` needs {distribution}, which is not installed; install it with: pip install "
    assert capsys.readouterr().err == f"{wanted}{distribution}\n"


@pytest.mark.usefixtures("only")
@pytest.mark.parametrize(
    ("arguments", "distribution"),
    [
        (["run", "basic", "--watch"], "basu-window"),
        (["run", "basic", "--keys", "data/human_session.json"], "basu-window"),
        (["run", "human"], "basu-window"),
        (["run", "basic", "--rosbag"], "basu-ros"),
        (["run", "autoware", "--in-process"], "basu-ros"),
        (["run", "egodriver:127.0.0.1:50051", "--in-process"], "basu-alpasim"),
        (["run", "basic", "--sumo"], "basu-sumo"),
    ],
)
def test_an_option_or_agent_without_its_plugin_ends_before_a_simulator_starts(
    arguments: list[str], distribution: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main([*arguments, "--output", str(tmp_path)]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert said[0].endswith(
        f"needs {distribution}, which is not installed; install it with: pip install {distribution}"
    )


@pytest.mark.usefixtures("only")
def test_a_leaderboard_agent_without_its_plugin_names_it(tmp_path: Path) -> None:
    path = tmp_path / "theirs.py"
    path.write_text("from leaderboard.autoagents.autonomous_agent import AutonomousAgent\n", "utf-8")
    with pytest.raises(UserError, match="needs basu-leaderboard, which is not installed"):
        load_agent(str(path))


@pytest.mark.usefixtures("only")
def test_a_campaign_with_a_search_names_its_plugin() -> None:
    with pytest.raises(UserError, match="a search or an estimate needs basu-search"):
        search_plugin()


@pytest.mark.usefixtures("only")
def test_the_core_prepares_a_run_without_any_plugin() -> None:
    assert prepare(RunOptions(agent="basic")).loaded.name == "basic"
    assert "ros" not in names()


@pytest.mark.usefixtures("stranger")
def test_the_plugin_of_another_project_brings_a_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["towns", "Linden"]) == 0
    assert capsys.readouterr().out == "towns Linden\n"
    with pytest.raises(SystemExit):
        main(["--help"])
    assert "list towns" in capsys.readouterr().out


@pytest.mark.usefixtures("stranger")
def test_the_plugin_of_another_project_brings_an_agent() -> None:
    loaded = load_agent("timid")
    assert (loaded.class_name, loaded.name, loaded.file) == ("Timid", "timid", None)
    with pytest.raises(UserError, match="did you mean 'timid'"):
        load_agent("timit")


@pytest.mark.usefixtures("stranger")
def test_the_plugin_of_another_project_reads_scenario_files(tmp_path: Path) -> None:
    case = next((Path(__file__).parents[1] / "src" / "basu" / "scenarios" / "library").glob("*/dooring.xml"))
    text = case.read_text("utf-8").replace('name="dooring', 'name="own_dooring')
    (tmp_path / "mine.cases").write_text(text, "utf-8")
    found = open_library([tmp_path / "mine.cases"])
    assert {each.name for each in found.cases if each.name.startswith("own_")}
    assert found.choose([str(tmp_path / "mine.cases")])


@pytest.mark.usefixtures("stranger")
def test_the_plugin_of_another_project_observes_each_drive() -> None:
    check_outputs(RunOptions(agent="basic"))
    import stranger  # noqa: PLC0415 - the fixture writes it

    assert stranger.CHECKED == ["basic"]


def test_each_plugin_of_this_project_is_found_where_its_metadata_says() -> None:
    for group, brought in plugins.DISTRIBUTIONS.items():
        for name, distribution in brought.items():
            entry = plugins.offered(group)[name]
            assert entry.dist is not None
            assert entry.dist.name == distribution
            assert entry.load() is not None


def test_the_extra_all_brings_every_plugin_of_the_benchmark() -> None:
    project = (Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8")
    (extra,) = [line for line in project.splitlines() if line.startswith("all = ")]
    named = {name for group in plugins.DISTRIBUTIONS.values() for name in group.values()}
    assert [name for name in sorted(named) if f'"{name}==' not in extra] == []
