"""A scenario's behaviour tree as plain values, as text, and in Graphviz's language."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, TypedDict

from py_trees.common import Status
from py_trees.composites import Parallel, Selector
from py_trees.composites import Sequence as Steps

from basu.scenarios.tree_node import BROKEN_OFF
from basu.scenarios.triggers.motion import Trigger

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from py_trees.behaviour import Behaviour

    from basu.scenarios.criteria.criterion import Criterion, Judgement
    from basu.scenarios.scenario import Composed


STATUS = {Status.SUCCESS: "success", Status.FAILURE: "failure", Status.RUNNING: "running"}


class TreeNode(TypedDict):
    """A node and all below it."""

    name: str
    kind: str  # sequence, parallel, selector, trigger, action, criterion
    status: str  # waiting (never begun), running, success, failure, broken off, not judged
    feedback: str  # in words, with figures; "" where there are none
    children: list[TreeNode]


def tree_of(composed: Composed, judgements: Sequence[Judgement] = (), criteria: Sequence[Criterion] = ()) -> TreeNode:
    """The tree as it was left, with the criteria's judgements, or before a run with their names.

    Without either, there is no branch of criteria.
    """
    root = composed.root.root
    behaviour = node_of(root)
    behaviour["name"] = "behaviour"
    leaves = [_judged(judgement) for judgement in judgements] or [
        TreeNode(name=criterion.name, kind="criterion", status="waiting", feedback="", children=[])
        for criterion in criteria
    ]
    branches = [behaviour]
    if leaves:
        branches.append(
            TreeNode(name="criteria", kind="parallel", status=_of_all(judgements), feedback="", children=leaves)
        )
    status = "failure" if branches[-1]["status"] == "failure" else behaviour["status"]
    return TreeNode(name=root.name, kind="parallel", status=status, feedback="", children=branches)


def node_of(behaviour: Behaviour) -> TreeNode:
    """A behaviour and all below it."""
    children = [node_of(child) for child in behaviour.children]
    return TreeNode(
        name=behaviour.name,
        kind=_kind(behaviour),
        status=STATUS.get(behaviour.status) or _status_before(behaviour, children),
        feedback=behaviour.feedback_message,
        children=children,
    )


def _status_before(behaviour: Behaviour, children: Sequence[TreeNode]) -> str:
    """What became of a node that py_trees has reset: an aborted composite forgets what its parts had done."""
    if children:
        return "waiting" if all(child["status"] == "waiting" for child in children) else "broken off"
    if not behaviour.feedback_message:
        return "waiting"
    return "broken off" if behaviour.feedback_message.startswith(BROKEN_OFF) else "success"


def walk(tree: TreeNode, depth: int = 0) -> Iterator[tuple[int, TreeNode]]:
    """Every node with its depth, from above."""
    yield depth, tree
    yield from itertools.chain.from_iterable(walk(child, depth + 1) for child in tree["children"])


def _kind(behaviour: Behaviour) -> str:
    """What a behaviour is, in a word."""
    for base, word in ((Steps, "sequence"), (Parallel, "parallel"), (Selector, "selector"), (Trigger, "trigger")):
        if isinstance(behaviour, base):
            return word
    return "action"


def _judged(judgement: Judgement) -> TreeNode:
    """A criterion with what it said."""
    held = "" if judgement.limit in {"", "none"} else f" ({judgement.limit})"
    return TreeNode(
        name=judgement.criterion if judgement.deciding else f"{judgement.criterion} (reported only)",
        kind="criterion",
        status="not judged" if judgement.passed is None else "success" if judgement.passed else "failure",
        feedback=judgement.sentence + held,
        children=[],
    )


def _of_all(judgements: Sequence[Judgement]) -> str:
    """The joint result of the deciding criteria."""
    said = [judgement.passed for judgement in judgements if judgement.deciding]
    if False in said:
        return "failure"
    return "success" if True in said else "not judged" if judgements else "waiting"


MARKS = {"success": "✓", "failure": "✗", "running": "▸", "broken off": "⊘", "not judged": "~", "waiting": "·"}
PLAIN_MARKS = {
    "success": "ok",
    "failure": "NO",
    "running": "..",
    "broken off": "x ",
    "not judged": "~ ",
    "waiting": "- ",
}
KINDS = {"sequence": "→", "parallel": "⇉", "selector": "?", "trigger": "◇", "action": "□", "criterion": "○"}
PLAIN_KINDS = {"sequence": "->", "parallel": "=>", "selector": "?", "trigger": "<>", "action": "[]", "criterion": "()"}
COLOURS = {
    "success": "#2e7d32",
    "failure": "#c62828",
    "running": "#1565c0",
    "broken off": "#8d6e63",
    "not judged": "#8a6d00",
    "waiting": "#78828c",
}
SHAPES = {"trigger": "hexagon", "criterion": "oval"}


def as_text(tree: TreeNode, *, plain: bool = False) -> str:
    """The tree indented, a node a line: its mark, its kind, its name and what it said. ``plain`` is ASCII."""
    marks, kinds = (PLAIN_MARKS, PLAIN_KINDS) if plain else (MARKS, KINDS)
    lines: list[str] = []

    def add(node: TreeNode, lead: str, below: str) -> None:
        said = f"  ({node['feedback']})" if node["feedback"] else ""
        lines.append(f"{marks[node['status']]} {lead}{kinds[node['kind']]} {node['name']}{said}")
        branch, last = ("|-- ", "`-- ") if plain else ("├─ ", "└─ ")
        along, blank = ("|   ", "    ") if plain else ("│  ", "   ")
        for number, child in enumerate(node["children"]):
            final = number == len(node["children"]) - 1
            add(child, below + (last if final else branch), below + (blank if final else along))

    add(tree, "", "")
    text = "\n".join(lines)
    return text.encode("ascii", "replace").decode() if plain else text


def as_dot(tree: TreeNode) -> str:
    """The tree as a graph for Graphviz's ``dot``."""
    lines = ["digraph scenario {", "  rankdir=LR;", '  node [shape=box, fontname="sans-serif", fontsize=11];']
    parents: list[int] = []  # the latest node at each depth
    for number, (depth, node) in enumerate(walk(tree)):
        label = f"{KINDS[node['kind']]} {node['name']}" + (f"\n{node['feedback']}" if node["feedback"] else "")
        colour, shape = COLOURS[node["status"]], SHAPES.get(node["kind"], "box")
        lines.append(f'  n{number} [label="{_quoted(label)}", color="{colour}", shape={shape}];')
        if depth:
            lines.append(f"  n{parents[depth - 1]} -> n{number};")
        parents[depth:] = [number]
    return "\n".join([*lines, "}"])


def _quoted(text: str) -> str:
    """Within the quotes of a dot label."""
    return text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
