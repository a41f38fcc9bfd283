"""Claims about finding an agent: by name, in a file without imports, and a sentence for every way that fails."""

import random
from pathlib import Path

import pytest

from basu.agents import loader as agent_loader
from basu.agents.autonomous_agent import AutonomousAgent
from basu.agents.loader import load_agent
from basu.agents.sight import Knowledge
from basu.errors import UserError
from basu.records.partners import Partner

SAMPLE = Path(__file__).parents[4] / "examples" / "forward_agent.py"
COMPLETE = """
class {name}(AutonomousAgent):
    def setup(self): pass
    def run_step(self, sensor_data): return carla.VehicleControl()
    def config(self): return {{}}
"""


def written(folder: Path, text: str) -> str:
    path = folder / "an_agent.py"
    path.write_text(text)
    return str(path)


def test_the_thesis_sample_is_loaded_as_it_stands_there() -> None:
    assert "import" not in SAMPLE.read_text()
    loaded = load_agent(str(SAMPLE))
    assert loaded.agent_class.__name__ == "ForwardAgent"
    assert loaded.name == "forward_agent"
    agent = loaded.agent_class()
    assert agent.run_step({}).throttle == pytest.approx(0.9)
    assert agent.config()["vehicle"] == "vehicle.tesla.model3"
    assert agent.get_initial_route_locations() is None


@pytest.mark.parametrize("name", ["basic", "forward", "blind", "creeper", "standing"])
def test_the_built_in_agents_are_found_by_name(name: str) -> None:
    loaded = load_agent(name)
    assert issubclass(loaded.agent_class, AutonomousAgent)
    assert (loaded.name, loaded.file) == (name, None)


def test_a_built_in_agent_knows_the_actors_in_sight_or_all() -> None:
    seeing, knowing = load_agent("behavioral"), load_agent("behavioral:full")
    assert seeing.agent_class.knowledge is Knowledge.SEEN  # type: ignore[attr-defined]
    assert knowing.agent_class.knowledge is Knowledge.FULL  # type: ignore[attr-defined]
    assert knowing.name == "behavioral-full"


@pytest.mark.parametrize("kind", [kind for kind in Partner if kind is not Partner.NONE])
def test_a_built_in_agent_can_be_blind_to_one_kind_of_partner(kind: Partner) -> None:
    blind = load_agent(f"behavioral:no-{kind.value}s")
    assert blind.agent_class.blind_to == {kind}  # type: ignore[attr-defined]
    assert blind.agent_class.knowledge is Knowledge.SEEN  # type: ignore[attr-defined]
    assert blind.name == f"behavioral-no-{kind.value}s"


@pytest.mark.parametrize(
    ("wanted", "sentence"),
    [
        (
            "basic:all",
            "'basic:all'; there are 'basic' and 'basic:full', and the control drivers 'basic:no-walkers'",
        ),
        ("blind:no-signs", "the agent 'blind' looks at no other actors; leave ':no-signs' out"),
        ("forward:full", "the agent 'forward' looks at no other actors; leave ':full' out"),
        ("blind:full", "the agent 'blind' looks at no other actors; leave ':full' out"),
    ],
)
def test_knowledge_that_there_is_not_is_refused(wanted: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        load_agent(wanted)


def test_imported_agents_are_not_taken_for_the_files_own(tmp_path: Path) -> None:
    text = "from basu.agents.builtin.baselines import ForwardAgent" + COMPLETE.format(name="Mine")
    assert load_agent(written(tmp_path, text)).agent_class.__name__ == "Mine"


def test_an_agent_may_be_of_several_files(tmp_path: Path) -> None:
    (tmp_path / "part_of_an_agent.py").write_text("THROTTLE = 0.25")
    text = "from part_of_an_agent import THROTTLE" + COMPLETE.format(name="Mine")
    assert load_agent(written(tmp_path, text)).agent_class.__name__ == "Mine"


def test_one_of_several_agents_is_named_behind_a_colon(tmp_path: Path) -> None:
    path = written(tmp_path, COMPLETE.format(name="First") + COMPLETE.format(name="Second"))
    assert load_agent(f"{path}:Second").agent_class.__name__ == "Second"
    with pytest.raises(UserError, match=r"holds 2 agents \(First, Second\); name one as .*:First"):
        load_agent(path)


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("basik", "no agent called 'basik'; did you mean 'basic'"),
        ("zzz", "there are autoware, autoware-ai, basic, behavioral, .*, forward, human, .*or name a Python file"),
        ("behavioral-careful", "did you mean 'behavioral-cautious'"),
        ("nowhere.py", "file nowhere.py does not exist"),
    ],
)
def test_a_name_that_is_none_gets_a_sentence(name: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        load_agent(name)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        pytest.param("x = 1", "holds no subclass of AutonomousAgent", id="no agent"),
        pytest.param("def f(:", "is no Python: line 1", id="no Python"),
        pytest.param("import nothing_of_this_name", "line 1: ModuleNotFoundError", id="import fails"),
        pytest.param("raise SystemExit(3)", "line 1: SystemExit: 3", id="ends the program"),
        pytest.param("x = 1\ny = x / 0", "line 2: ZeroDivisionError", id="raises"),
        pytest.param(
            "class A(AutonomousAgent):\n  def setup(self): pass", "A in .* lacks config, run_step", id="incomplete"
        ),
    ],
)
def test_a_file_that_is_no_agent_gets_a_sentence(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(UserError, match=sentence):
        load_agent(written(tmp_path, text))


def test_a_file_that_never_ends_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agent_loader, "LOAD_LIMIT_S", 0.1)
    with pytest.raises(UserError, match=r"an_agent.py was not loaded within 0.1 s"):
        load_agent(written(tmp_path, "while True: pass"))


@pytest.mark.parametrize("seed", range(20))
def test_any_bytes_at_all_get_a_sentence(tmp_path: Path, seed: int) -> None:
    (tmp_path / "an_agent.py").write_bytes(random.Random(seed).randbytes(seed * 5))
    with pytest.raises(UserError, match=r"an_agent\.py"):
        load_agent(str(tmp_path / "an_agent.py"))
