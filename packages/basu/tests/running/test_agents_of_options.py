"""Claims about agents that options name: a run and a case load them by the same function, with the same text."""

import pytest

from basu.options.drive import DriveOptions
from basu.options.run import RunOptions
from basu.running.preparation import agent_of
from basu.running.scenario_runs.options import ScenarioOptions


@pytest.mark.parametrize("model", [RunOptions, ScenarioOptions])
def test_the_text_for_an_agents_setup_reaches_it_on_a_route_and_in_a_case(
    model: type[DriveOptions], monkeypatch: pytest.MonkeyPatch
) -> None:
    heard: list[str | None] = []
    monkeypatch.setattr("basu.agents.process.remote_agent.load_agent", lambda _, text: heard.append(text))
    agent_of(model(agent_config="a text", in_process=True), "told.py")
    assert heard == ["a text"]
