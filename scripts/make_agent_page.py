"""Fill the tables of docs/reference/agent-api.md from the agent's base class: `make_agent_page.py [--check]`.

Each table stands in the page between ``<!-- NAME -->`` and ``<!-- /NAME -->``; the rest of the page is written by hand.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import griffe
from generated_page import replaced, write_or_check

from basu.agents.autonomous_agent import AgentConfig, AutonomousAgent
from basu.agents.sight import Other
from basu.routing import Route, RouteControl, Stop

PAGE = Path(__file__).parent.parent / "docs" / "reference" / "agent-api.md"
CALLED_BY_BASU = ("config", "sensors", "get_initial_route_locations", "setup", "run_step", "destroy")
FOR_THE_AGENT = ("visible_actors", "send")
INTERNAL = ("bind", "bind_sensors")


def files() -> dict[Path, str]:
    """Return the page with its tables."""
    text = PAGE.read_text("utf-8")
    for name, make in TABLES.items():
        text = replaced(text, name, make())
    return {PAGE: text}


def attributes() -> str:
    """Return the table of the base class's attributes."""
    types = annotations(AutonomousAgent)
    rows = [(f"`self.{name}`", code(types[name]), text) for name, text in documented(AutonomousAgent).items()]
    return table(("attribute", "type", "meaning"), rows)


def methods(names: tuple[str, ...]) -> Callable[[], str]:
    """Return a function that returns a section for each of these methods."""
    return lambda: "\n\n".join(method(name) for name in names)


def method(name: str) -> str:
    """Return heading, signature and docstring of a method of the base class."""
    member = getattr(AutonomousAgent, name)
    needed = "to implement" if getattr(member, "__isabstractmethod__", False) else "optional"
    if name in FOR_THE_AGENT:
        needed = "to call"
    signature = re.sub(r"<([^>]*)>", r"\1", str(inspect.signature(member)))
    lines = [f"### `{name}` ({needed})", "", "```python", f"def {name}{signature}".replace("'", ""), "```", ""]
    return "\n".join([*lines, markdown(inspect.getdoc(member) or "")])


def markdown(docstring: str) -> str:
    """Return a Google docstring as Markdown: the text, then the arguments and the result."""
    parts = []
    for section in parsed(docstring):
        if section.kind is griffe.DocstringSectionKind.text:
            parts.append(plain(section.value))
        elif section.kind is griffe.DocstringSectionKind.parameters:
            parts += [f"**`{entry.name}`**: {plain(entry.description)}" for entry in section.value]
        elif section.kind is griffe.DocstringSectionKind.returns:
            parts += [f"**Returns** {first_small(plain(entry.description))}" for entry in section.value]
    return "\n\n".join(parts)


def config_keys() -> str:
    """Return the table of the keys of ``config`` and their defaults."""
    rows = [
        (f"`{field.name}`", f"`{field.default}`" if field.default else "none", CONFIG_MEANINGS[field.name])
        for field in dataclasses.fields(AgentConfig)
    ]
    return table(("key", "default", "meaning"), rows)


CONFIG_MEANINGS = {
    "routes": "a route file; `--routes` replaces it",
    "sensors": "a sensor file; none: the agent drives without sensors",
    "sumo": "SUMO's traffic: a folder with a `.sumocfg` file, where SUMO is installed; `--sumo` replaces it",
    "track": "what the agent learns of others: `world`, `objects` or `sensors`; `--track` replaces it",
    "vehicle": "the blueprint; `--vehicle` replaces it",
    "weather": "one of CARLA's presets; the weather of the route and `--weather` replace it",
}


def fields(of: type) -> Callable[[], str]:
    """Return a function that returns the table of a class's fields, with the comments beside them."""
    return lambda: table(("field", "type", "meaning"), list(field_rows(of)))


def field_rows(of: type) -> Iterator[tuple[str, str, str]]:
    """Yield name, type and meaning of each field: from the docstring, or from the comment in the field's line."""
    described = documented(of)
    for line in inspect.getsource(of).splitlines():
        found = re.match(r"    (\w+): ([^#=]+?)(?: = [^#]*)?(?:  # (.*))?$", line)
        if found and not found[1].startswith("_"):
            yield f"`{found[1]}`", code(found[2]), described.get(found[1]) or first_large(found[3] or "")


def documented(of: type) -> dict[str, str]:
    """Return the attributes that a class's docstring describes."""
    found: dict[str, str] = {}
    for section in parsed(inspect.getdoc(of) or ""):
        if section.kind is griffe.DocstringSectionKind.attributes:
            for entry in section.value:
                found[entry.name] = first_large(plain(entry.description))
    return found


def annotations(of: type) -> dict[str, str]:
    """Return the public attributes of a class with their types, as the source states them."""
    return {name: str(kind) for name, kind in of.__annotations__.items() if not name.startswith("_")}


def parsed(docstring: str) -> list[griffe.DocstringSection]:
    """Return the sections of a Google docstring."""
    several = re.compile(r"^( +)(\w+), ([\w, ]+): (.*)$", re.MULTILINE)  # "x_m, y_m: place" describes two attributes
    while several.search(docstring):
        docstring = several.sub(r"\1\2: \4\n\1\3: \4", docstring)
    return griffe.Docstring(docstring).parse(
        "google", warnings=False, returns_multiple_items=False, returns_named_value=False
    )


def plain(text: str) -> str:
    """Return reStructuredText of a docstring as Markdown on one line a paragraph."""
    text = re.sub(r":\w+:`~?([^`]+)`", r"`\1`", text.replace("``", "`"))
    return "\n\n".join(" ".join(paragraph.split()) for paragraph in text.split("\n\n"))


def first_large(text: str) -> str:
    """Return a text with a capital at its beginning, unless it begins with code."""
    return text[:1].upper() + text[1:]


def first_small(text: str) -> str:
    """Return a text with a small letter at its beginning."""
    return text[:1].lower() + text[1:]


def code(text: str) -> str:
    """Return a type as code that does not end its cell."""
    return f"`{text.strip()}`".replace(" | ", " or ")


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """Return a Markdown table."""
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


TABLES: dict[str, Callable[[], str]] = {
    "attributes": attributes,
    "methods": methods(CALLED_BY_BASU),
    "services": methods(FOR_THE_AGENT),
    "config": config_keys,
    "route": fields(Route),
    "control": fields(RouteControl),
    "stop": fields(Stop),
    "other": fields(Other),
}

if __name__ == "__main__":
    sys.exit(write_or_check(__file__, __doc__, files))
