"""Trees drawn: as plain values, text, a graph and a picture."""

from basu.scenarios.drawing.draw import FORMS, draw
from basu.scenarios.drawing.nodes import TreeNode, tree_of
from basu.scenarios.drawing.svg import as_svg
from basu.scenarios.drawing.text import as_dot, as_text

__all__ = ["FORMS", "TreeNode", "as_dot", "as_svg", "as_text", "draw", "tree_of"]
