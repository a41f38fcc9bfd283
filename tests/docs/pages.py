"""README and the pages of docs/, with the code blocks and the inline code that they show."""

import re
import runpy
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)
INDENTED = re.compile(r"(?:^    .*\n)+", re.MULTILINE)
INLINE = re.compile(r"(?<!`)`([^`\n]+(?:\n[^`\n]+)?)`(?!`)")
SHELL = {"", "bash", "sh", "console"}


class Shown(NamedTuple):
    """A command as a page shows it: in a block, to be typed, or in a sentence, perhaps without its arguments."""

    page: str
    words: tuple[str, ...]
    in_block: bool


def without_fences(text: str) -> str:
    """Return a page without its fenced blocks."""
    return FENCE.sub("", text)


def shell_lines(text: str) -> Iterator[str]:
    """Yield the lines of the blocks that may hold commands, with continued lines joined."""
    blocks = [block for language, block in FENCE.findall(text) if language in SHELL]
    blocks += INDENTED.findall(without_fences(text))
    for block in blocks:
        yield from block.replace("\\\n", " ").splitlines()


def commands() -> Iterator[Shown]:
    """Yield each command of ``basu`` and ``linden`` in blocks and in inline code."""
    for page in PAGES:
        text = page.read_text("utf-8")
        inline = (code.replace("\n", " ") for code in INLINE.findall(without_fences(text)) if "|" not in code)
        lines = [*((line, True) for line in shell_lines(text)), *((line, False) for line in inline)]
        for line, in_block in lines:
            words = command_in(line)
            if words:
                yield Shown(str(page.relative_to(ROOT)), words, in_block)


def command_in(line: str) -> tuple[str, ...]:
    """Return the words of the command that a line begins with; () where it is no command of ours."""
    if not re.match(r"\s*(\.venv/bin/)?(basu|linden) [\w-]", line):
        return ()
    line = re.split(r"  +#|\s#\s|   |\s[&|>]|;", line.strip())[0]
    try:
        words = shlex.split(line)
    except ValueError:  # an apostrophe of a sentence: a line of output
        return ()
    return (words[0].removeprefix(".venv/bin/"), *words[1:])


def run_script(patch: pytest.MonkeyPatch, name: str, *arguments: str) -> object:
    """Run one of ``scripts`` as a program, in this process and from the root; return its exit code."""
    file = ROOT / "scripts" / name
    patch.chdir(ROOT)
    patch.syspath_prepend(file.parent)
    patch.setattr(sys, "argv", [str(file), *arguments])
    with pytest.raises(SystemExit) as ended:
        runpy.run_path(str(file), run_name="__main__")
    return ended.value.code
