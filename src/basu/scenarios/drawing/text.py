"""A tree as text for a console, and in Graphviz's language."""

from __future__ import annotations

from typing import TYPE_CHECKING

from basu.scenarios.drawing.nodes import walk

if TYPE_CHECKING:
    from basu.scenarios.drawing.nodes import TreeNode

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
