"""Fill the tables and files of docs/reference/scenarios.md from the code: `make_scenarios_page.py [--check]`.

Each stands in the page between ``<!-- NAME -->`` and ``<!-- /NAME -->``; what is outside is written by hand.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

from generated_page import write_or_check

from basu.scenarios import actions, criteria, paths, triggers
from basu.scenarios.cases import ALL, open_library, snake
from basu.scenarios.listing import as_text, listed
from basu.scenarios.nhtsa import PRINTED_SUMS, TABLE_1_1, Group, stands_for

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "reference" / "scenarios.md"
EXAMPLE = ROOT / "examples" / "scenarios" / "bin_lorry.xml"
BASES = {
    "Trigger",
    "Action",
    "PathFollower",
    "Aspect",
    "Criterion",
    "Judgement",
    "Played",
    "Thing",
    "reported_always",
    "margins_of",
}


def filled(page: str) -> str:
    """The page with every part made anew."""
    for name, part in PARTS.items():
        pattern = re.compile(f"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.DOTALL)
        if not pattern.search(page):
            raise SystemExit(f"docs/reference/scenarios.md has no <!-- {name} --> … <!-- /{name} -->")
        text = part()
        page = pattern.sub(lambda found, text=text: f"{found[1]}{text}\n{found[2]}", page)
    return page


def table_1_1() -> str:
    """Table 1.1 of the thesis, with its printed sums."""
    heads = (
        "group",
        "fatal crashes with a light vehicle in the critical event",
        "all crashes with one",
        "fatal crashes in which a light vehicle makes the critical action",
        "all such crashes",
        "fatal, for 10⁹ miles",
        "all, for 10⁹ miles",
        "cost, 10⁶ $",
        "equivalent lives",
        "fatal for 1,000 crashes",
    )
    rows = [*((group.value, row) for group, row in TABLE_1_1.items()), ("sum, as printed", PRINTED_SUMS)]
    written = ["| " + " | ".join([name, *(f"{value:,}" for value in row)]) + " |" for name, row in rows]
    return "\n".join(["| " + " | ".join(heads) + " |", "|---" + "|---:" * (len(heads) - 1) + "|", *written])


def catalogue() -> str:
    """What comes with BASU, by group."""
    library = open_library()
    cases = [playable.scenario for playable in library.choose([ALL])]
    lines = [
        "| group | scenario | what happens | cases | stands for | reads ScenarioRunner's |",
        "|---|---|---|---|---|---|",
    ]
    for group in Group:
        for scenario in (scenario for scenario in library.scenarios if scenario.group is group):
            theirs = ", ".join(f"`{name}`" for name in scenario.aliases)
            kinds = stands_for(scenario.__name__, group, scenario.pre_crash)
            numbers = ", ".join(str(kind.number) for kind in kinds)
            name, count = f"`{snake(scenario.__name__)}`", str(cases.count(scenario))
            row = (group.value, name, scenario.title(), count, numbers, theirs)
            lines.append(f"| {' | '.join(map(cell, row))} |")
    return "\n".join(lines)


def example_list() -> str:
    """What `basu scenario list` says of the example."""
    lines = as_text(listed(open_library([EXAMPLE]), [str(EXAMPLE)]), full=True)
    return "\n".join(["```", *(line.rstrip() for line in lines), "```"])


def members(module: ModuleType) -> Callable[[], str]:
    """A table of what a package offers."""

    def table() -> str:
        lines = ["| write | it |", "|---|---|"]
        for name in module.__all__:
            if name not in BASES:
                member = getattr(module, name)
                lines.append(f"| `{cell(call(name, member))}` | {cell(first_paragraph(member))} |")
        return "\n".join(lines)

    return table


def call(name: str, member: Callable[..., object]) -> str:
    """How it is written: names and defaults, without types."""
    signature = inspect.signature(member)
    bare = [p.replace(annotation=inspect.Parameter.empty) for p in signature.parameters.values()]
    plain = signature.replace(parameters=bare, return_annotation=inspect.Signature.empty)
    named = re.sub(r"<(\w+\.\w+): [^>]*>", r"\1", str(plain))  # a member of an enum as one writes it
    return name + re.sub(r"Limits\([^)]+\)", "Limits()", named)


def first_paragraph(member: object) -> str:
    """What its docstring begins with."""
    return " ".join((inspect.getdoc(member) or "").split("\n\n")[0].split())


def cell(text: str) -> str:
    """Text that does not end its cell."""
    return text.replace("|", "\\|").replace("``", "`")


def file(path: Path, language: str) -> Callable[[], str]:
    """A file as it stands."""
    return lambda: f"```{language}\n{path.read_text('utf-8').strip()}\n```"


PARTS: dict[str, Callable[[], str]] = {
    "table 1.1": table_1_1,
    "catalogue": catalogue,
    "triggers": members(triggers),
    "actions": members(actions),
    "criteria": members(criteria),
    "paths": members(paths),
    "example class": file(EXAMPLE.with_suffix(".py"), "python"),
    "example list": example_list,
    "example case": file(EXAMPLE, "xml"),
}

if __name__ == "__main__":
    sys.exit(write_or_check(__file__, __doc__, lambda: {PAGE: filled(PAGE.read_text("utf-8"))}))
