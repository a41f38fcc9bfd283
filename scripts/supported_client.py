"""The client's part of docs/supported.md, made of what was observed (docs/supported.json); nothing is started here."""

import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

from every_method.outcome import RECORD, Kind, Outcome, from_json

Outcomes = Mapping[str, Outcome]

_KINDS = {
    "with the server": (Kind.WORKS,),
    "in the client": (Kind.CLIENT,),
    "refused": (Kind.REFUSED, Kind.LOGGED),
    "the client's own defect": (Kind.DEFECT,),
}
_TOLD = {Kind.REFUSED: "the client raises", Kind.LOGGED: "the server's log has"}


def observed() -> Outcomes:
    """Return what came of calling every member."""
    return from_json(RECORD.read_text("utf-8"))


def called(outcomes: Outcomes) -> set[str]:
    """Return the remote functions that any member calls."""
    return {function for found in outcomes.values() for function in found.functions}


def refused_functions(outcomes: Outcomes) -> set[str]:
    """Return the remote functions of which every call was refused."""
    refused = {function for found in outcomes.values() if found.kind in _TOLD for function in found.functions}
    return refused - {
        function for found in outcomes.values() if found.kind is Kind.WORKS for function in found.functions
    }


def totals(outcomes: Outcomes) -> list[str]:
    """Return the rows of the table at the top."""
    kinds = {
        "methods and properties": [
            member for member in outcomes if not is_operator(member) and not is_constant(member)
        ],
        "constructors, operators, `str`": [member for member in outcomes if is_operator(member)],
        "constants": [member for member in outcomes if is_constant(member)],
    }
    lines = [f"| the official client's | {' | '.join(_KINDS)} | in all |", "|---" * (len(_KINDS) + 2) + "|"]
    for name, members in {**kinds, "in all": list(outcomes)}.items():
        counts = [sum(outcomes[member].kind in kind for member in members) for kind in _KINDS.values()]
        lines.append(f"| {name} | {' | '.join(map(str, counts))} | {len(members)} |")
    return lines


def is_constant(member: str) -> bool:
    """Whether a member is a value of an enum or a ready-made weather: they alone begin with a capital."""
    name = member.rsplit(".", 1)[1]
    return name[0].isupper() or name in ("names", "values")


def is_operator(member: str) -> bool:
    """Whether a member is called by Python itself."""
    return member.endswith("__")


def refused(outcomes: Outcomes) -> list[str]:
    """Return the table of what is refused: a row a sentence."""
    rows: defaultdict[tuple[Kind, str], list[str]] = defaultdict(list)
    for member, found in outcomes.items():
        if found.kind in _TOLD:
            rows[found.kind, found.sentence].append(member)
    lines = ["| members | reported by | the sentence |", "|---|---|---|"]
    lines += [
        f"| {named(members)} | {_TOLD[kind]} | {cell(sentence)} |"
        for (kind, sentence), members in sorted(rows.items(), key=lambda row: row[1])
    ]
    return lines


def defects(outcomes: Outcomes) -> list[str]:
    """Return the table of what the client cannot do, against whatever server."""
    lines = ["| member | what happens |", "|---|---|"]
    lines += [
        f"| `{member}` | {cell(found.sentence)} |" for member, found in outcomes.items() if found.kind is Kind.DEFECT
    ]
    return lines


def with_the_server(outcomes: Outcomes) -> list[str]:
    """Return the table of what works by remote functions: a row for the members of a class that call the same."""
    rows: defaultdict[tuple[str, tuple[str, ...]], list[str]] = defaultdict(list)
    for member, found in outcomes.items():
        if found.kind is Kind.WORKS:
            rows[member.rsplit(".", 1)[0], found.functions].append(member)
    lines = ["| class | members | remote functions |", "|---|---|---|"]
    lines += [f"| `{owner}` | {names(members)} | {code(functions)} |" for (owner, functions), members in rows.items()]
    return lines


def in_the_client(outcomes: Outcomes) -> list[str]:
    """Return the table of what works in the client: a row a class, constants left out."""
    rows: defaultdict[str, list[str]] = defaultdict(list)
    for member, found in outcomes.items():
        if found.kind is Kind.CLIENT and not is_constant(member):
            rows[member.rsplit(".", 1)[0]].append(member)
    lines = ["| class | members |", "|---|---|"]
    lines += [f"| `{owner}` | {names(members)} |" for owner, members in rows.items()]
    return lines


def named(members: Iterable[str]) -> str:
    """Return members with their classes, each class once."""
    rows: defaultdict[str, list[str]] = defaultdict(list)
    for member in members:
        rows[member.rsplit(".", 1)[0]].append(member)
    return "; ".join(f"`{owner}`: {names(found)}" for owner, found in rows.items())


def names(members: Iterable[str]) -> str:
    """Return members without their class; what Python itself calls is counted."""
    members = list(members)
    spoken = [member.rsplit(".", 1)[1] for member in members if not is_operator(member)]
    operators = [member for member in members if is_operator(member)]
    parts = [code(spoken)] if spoken else []
    if operators:
        parts.append(code(member.rsplit(".", 1)[1].strip("_") for member in operators) + " (Python's)")
    return ", ".join(parts)


def code(words: Iterable[str]) -> str:
    """Return words as code, after one another."""
    return ", ".join(f"`{word}`" for word in words)


def cell(text: str) -> str:
    """Return a text that does not break a table."""
    return text.replace("|", "\\|").replace("\n", " ")
