"""Finds an agent's class: by name among BASU's own, or in a Python file of BASU's kind or the leaderboard's."""

from __future__ import annotations

import difflib
import importlib
import inspect
import re
import traceback
from pathlib import Path
from typing import NamedTuple

import carla

from basu import plugins
from basu.agents import agent_files
from basu.agents.agent_files import AgentFile
from basu.agents.autonomous_agent import AddressedAgent, AutonomousAgent
from basu.agents.calls import OverrunError, call_within
from basu.agents.sight import Knowledge
from basu.errors import UserError
from basu.files import module_of
from basu.records.partners import Partner

BUILT_IN = {
    "basic": "basu.agents.builtin.basic:BasicAgent",
    "behavioral": "basu.agents.builtin.behavioral:BehavioralAgent",
    "behavioral-cautious": "basu.agents.builtin.behavioral:CautiousAgent",
    "behavioral-aggressive": "basu.agents.builtin.behavioral:AggressiveAgent",
    "blind": "basu.agents.builtin.baselines:BlindAgent",
    "cooperative": "basu.agents.builtin.cooperative:CooperativeAgent",
    "creeper": "basu.agents.builtin.baselines:CreeperAgent",
    "standing": "basu.agents.builtin.baselines:StandingAgent",
    "deviating": "basu.agents.builtin.behavioral:DeviatingAgent",
    "forward": "basu.agents.builtin.baselines:ForwardAgent",
    "human": "basu.agents.builtin.basic:HumanAgent",
    "incident": "basu.agents.builtin.incident",
}

PERCEPTIONS: dict[str, dict[str, object]] = {  # what a variant of a built-in agent has in place of the agent's own
    Knowledge.FULL.value: {"knowledge": Knowledge.FULL},
    **{f"no-{kind.value}s": {"blind_to": frozenset({kind})} for kind in Partner if kind is not Partner.NONE},
}

NOT_IN_NAMES = r"[^\w.-]+"  # of an address, in the name of a folder
LOAD_LIMIT_S = 120.0  # of wall time: what an agent imports may be large


class LoadedAgent(NamedTuple):
    """An agent's class, a short name for folders and tables, and the file it came from (None: BASU's own)."""

    agent_class: type[AutonomousAgent]
    name: str
    file: Path | None

    @property
    def class_name(self) -> str:
        """The name of the class."""
        return self.agent_class.__name__

    @property
    def confinement(self) -> None:
        """What confines the agent: nothing, since it runs in the benchmark's process."""
        return

    @property
    def is_human(self) -> bool:
        """Whether a person drives at first."""
        return self.agent_class.driven_by_person


def names() -> list[str]:
    """Return the names of all agents that are installed: BASU's own, and those of plugins."""
    return sorted([*BUILT_IN, *plugins.offered(plugins.AGENTS)])


def is_name(name: str) -> bool:
    """Return whether a word is the name of an agent, of BASU's or of a plugin's, and so no file."""
    return (
        name in BUILT_IN or name in plugins.DISTRIBUTIONS[plugins.AGENTS] or plugins.is_installed(plugins.AGENTS, name)
    )


def load_agent(wanted: str, agent_config: str | None = None) -> LoadedAgent:
    """The agent called ``wanted``: a name, ``file.py``, or ``file.py:ClassName`` where a file holds several.

    ``basic:full`` is ``basic`` with full knowledge of others, instead of those in its line of sight.
    ``basic:no-cyclists`` is ``basic`` blind to cyclists; so for every kind of ``basu.records.partners.Partner``.
    ``egodriver:HOST:PORT`` is the software at an address (`AddressedAgent`).

    ``agent_config`` is the text of ``--agent-config``: agents of the leaderboard and of ScenarioRunner take one, mostly
    a file's name.

    Raises:
        UserError: there is none, the file does not load, or it holds no agent or more than one.
    """
    loaded = _find(wanted, agent_config)
    if agent_config is not None and not agent_files.takes_config(loaded.agent_class):
        raise UserError(
            f"the agent '{wanted}' takes no --agent-config: that is for agents of the leaderboard and of "
            "ScenarioRunner; remove the option"
        )
    return loaded


def _find(wanted: str, agent_config: str | None) -> LoadedAgent:
    """The agent by its name or from its file."""
    name, _, knowledge = wanted.partition(":")
    if name in BUILT_IN:
        module_name, _, class_name = BUILT_IN[name].partition(":")
        agents = _agents_in(vars(importlib.import_module(module_name)), module_name)
        agent = _only([a for a in agents if class_name in {"", a.__name__}], name)
        return _with_knowledge(agent, name, knowledge)
    if is_name(name):
        return _with_knowledge(plugins.load(plugins.AGENTS, name, f"the agent '{name}'"), name, knowledge)
    text, _, class_name = wanted.partition(":") if ".py:" in wanted else (wanted, "", "")
    path = Path(text)
    if path.suffix != ".py":
        known = names()
        close = difflib.get_close_matches(wanted, known, 1)
        hint = f"did you mean '{close[0]}'?" if close else f"there are {', '.join(known)}, or name a Python file"
        raise UserError(f"there is no agent called '{wanted}'; {hint}")
    if not path.is_file():
        raise UserError(f"the agent's file {path} does not exist; check the name and the folder you are in")
    namespace, module_name = _run_file(path)
    agents = _agents_in(namespace, module_name)
    file = AgentFile(namespace, module_name, str(path), class_name or None)
    if (foreign := agent_files.foreign_agent(file, agent_config, has_own=bool(agents))) is not None:
        return LoadedAgent(foreign, path.stem, path)
    if class_name:
        agents = [agent for agent in agents if agent.__name__ == class_name]
    return LoadedAgent(_only(agents, str(path)), path.stem, path)


def _with_knowledge(agent: type[AutonomousAgent], name: str, knowledge: str) -> LoadedAgent:
    """An agent as it is, a variant of its perception (``basic:full``, ``basic:no-cyclists``), or one at an address."""
    if not knowledge:
        return LoadedAgent(agent, name, None)
    if issubclass(agent, AddressedAgent):
        addressed = type(agent.__name__, (agent,), {"address": knowledge, "__module__": agent.__module__})
        return LoadedAgent(addressed, f"{name}-{re.sub(NOT_IN_NAMES, '-', knowledge)}", None)
    if getattr(agent, "knowledge", Knowledge.NONE) is Knowledge.NONE:
        raise UserError(f"the agent '{name}' looks at no other actors; leave ':{knowledge}' out")
    if knowledge not in PERCEPTIONS:
        raise UserError(
            f"there is no agent '{name}:{knowledge}'; there are '{name}' and '{name}:full', and the control drivers "
            + ", ".join(f"'{name}:{each}'" for each in PERCEPTIONS if each != Knowledge.FULL.value)
        )
    variant = type(agent.__name__, (agent,), {**PERCEPTIONS[knowledge], "__module__": agent.__module__})
    return LoadedAgent(variant, f"{name}-{knowledge}", None)


def _run_file(path: Path) -> tuple[dict[str, object], str]:
    """Execute an agent's file as a module that already knows ``carla`` and ``AutonomousAgent``.

    The thesis prints its sample agent without import lines (figure 4.9); such a file is complete here.
    """
    agent_files.prepare()
    name = f"basu_agent_{path.stem}"
    module, loader = module_of(path, name)
    module.__dict__.update(carla=carla, AutonomousAgent=AutonomousAgent)
    try:
        call_within(LOAD_LIMIT_S, lambda: loader.exec_module(module))
    except OverrunError:
        raise UserError(f"the agent's file {path} was not loaded within {LOAD_LIMIT_S:g} s") from None
    except SyntaxError as error:
        raise UserError(f"the agent's file {path} is no Python: line {error.lineno}: {error.msg}") from error
    except (Exception, SystemExit) as error:
        line = next(
            (f.lineno for f in reversed(traceback.extract_tb(error.__traceback__)) if f.filename == module.__file__), 0
        )
        raise UserError(
            f"the agent's file {path} does not load: line {line}: {type(error).__name__}: {error}"
            f"{agent_files.hint_on(error)}"
        ) from error
    return module.__dict__, name


def _agents_in(namespace: dict[str, object], module_name: str) -> list[type[AutonomousAgent]]:
    """The agents that a module defines itself."""
    return [
        value
        for value in namespace.values()
        if isinstance(value, type) and issubclass(value, AutonomousAgent) and value.__module__ == module_name
    ]


def _only(agents: list[type[AutonomousAgent]], where: str) -> type[AutonomousAgent]:
    """Return the only agent of a module."""
    if not agents:
        raise UserError(
            f"{where} holds no subclass of AutonomousAgent, of BASU's, the leaderboard's or ScenarioRunner's; "
            "see `examples/` for how an agent looks"
        )
    concrete = [agent for agent in agents if not inspect.isabstract(agent)]
    if not concrete:
        missing = ", ".join(sorted(agents[0].__abstractmethods__))
        raise UserError(f"{agents[0].__name__} in {where} lacks {missing}; an agent has setup, run_step and config")
    if len(concrete) > 1:
        names = [agent.__name__ for agent in concrete]
        raise UserError(f"{where} holds {len(names)} agents ({', '.join(names)}); name one as {where}:{names[0]}")
    return concrete[0]
