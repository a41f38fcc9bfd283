"""Check the language of code and documents: words to avoid, and sentences that are too long.

usage: check_language.py [--list TREE] [--lower]

Counts the findings in each tree and compares them with ``language_baseline.json``. A count above its baseline fails,
and the findings of that tree are printed with file, line and suggestion. ``--list TREE`` prints all findings of a tree.
``--lower`` writes lower counts into the baseline; no option raises one.
"""

import argparse
import ast
import io
import json
import re
import subprocess
import sys
import tokenize
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parent.parent
BASELINE = Path(__file__).with_name("language_baseline.json")
LONGEST_SENTENCE = 25
"""Words of a sentence in documents and docstrings; docs/decisions/0064-layout-and-language.md says why."""

TREES: dict[str, tuple[str, ...]] = {
    "src/linden": ("src/linden/**/*.py",),
    "src/basu": ("src/basu/**/*.py",),
    "src/linden_window": ("src/linden_window/**/*.py",),
    "src/basu_window": ("src/basu_window/**/*.py",),
    "src/linden_gym": ("src/linden_gym/**/*.py",),
    "docs": ("docs/**/*.md", "README.md", "CONTRIBUTING.md", "examples/**/*.md"),
    "tests": ("tests/**/*.py",),
}

WORDS = {
    "who|whoever|whom|whose": "name the thing or the role: the client, the driver, the actor",
    "nobody|somebody|anybody": 'name the thing or the role: "no client", "a subscriber"',
    "is told|are told": 'use an active verb: "the server sends ..."',
    "is asked|are asked": 'use an active verb: "the client requests ..."',
    "of all that": "name what is meant",
    "left away|leave away": "skip, omit",
    "those that": "name the thing: actors that, lanes that",
    "lets? happen": "use the verb of what is done",
    "darkroom|darkrooms": "renderer",
    "eavesdropper|eavesdroppers": "recording proxy",
    "crew": "thread pool, worker pool",
}
"""Regular expression of whole words -> what to write instead."""

_AVOID = [(re.compile(rf"\b(?:{words})\b", re.IGNORECASE), advice) for words, advice in WORDS.items()]
_NAME = re.compile(r"^\s*(?:async )?(?:def (test_\w+)|class (Test\w+))")
_SENTENCE_END = re.compile(r"(?<=[.!?])[\"')`*]*\s+(?=[\"'(`*]*[A-Z0-9])|;\s|\n\s*\n|\n\s*(?:[-*]|\d+\.)\s")
_WORD = re.compile(r"[A-Za-z][\w'-]*")
_SECTION = re.compile(r"^( *)(?:Args|Attributes|Raises):\n(?:(?:\1 +\S.*)?(?:\n|$))+", re.MULTILINE)
_ENTRY = re.compile(r"\n(?= +[\w*]+: )")


class Finding(NamedTuple):
    """A place, what is wrong there, and what to write instead."""

    kind: str
    file: Path
    line: int
    text: str
    advice: str


def avoided_words(file: Path, lines: list[str]) -> Iterator[Finding]:
    """Yield the lines with a word to avoid, each line once."""
    for number, line in enumerate(lines, 1):
        for pattern, advice in _AVOID:
            if found := pattern.search(line):
                yield Finding("words", file, number, found[0], advice)
                break


def test_names(file: Path, lines: list[str]) -> Iterator[Finding]:
    """Yield the names of tests with a word to avoid."""
    for number, line in enumerate(lines, 1):
        if name := _NAME.match(line):
            spoken = (name[1] or name[2]).replace("_", " ")
            for pattern, advice in _AVOID:
                if found := pattern.search(spoken):
                    yield Finding("names", file, number, f"{found[0]} in {name[1] or name[2]}", advice)
                    break


def long_sentences(file: Path, first_line: int, text: str) -> Iterator[Finding]:
    """Yield the sentences of a text with more than LONGEST_SENTENCE words."""
    at = 0
    for end in [*_SENTENCE_END.finditer(text), None]:
        stop = len(text) if end is None else end.start()
        sentence = text[at:stop]
        count = len(_WORD.findall(re.sub(r"``?[^`]*``?|\([^()]*\)|https?://\S+", "X", sentence)))
        if count > LONGEST_SENTENCE:
            line = first_line + text.count("\n", 0, at + len(sentence) - len(sentence.lstrip()))
            start = " ".join(sentence.split())[:60]
            yield Finding(
                "sentences", file, line, f'{count} words: "{start} ..."', "one statement a sentence; split it"
            )
        at = stop if end is None else end.end()


def docstrings(source: str) -> Iterator[tuple[int, str]]:
    """Yield first line and text of every docstring and of every text below a constant."""
    for node in ast.walk(ast.parse(source)):
        for statement in getattr(node, "body", []) if not isinstance(node, (ast.Lambda, ast.IfExp)) else []:
            value = statement.value if isinstance(statement, ast.Expr) else None
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                yield statement.lineno, entries_apart(value.value)


def entries_apart(text: str) -> str:
    """Return a docstring in which a semicolon ends each entry of its lists of arguments, attributes and errors."""
    return _SECTION.sub(lambda section: _ENTRY.sub(";\n", section[0]), text)


def comments(source: str) -> Iterator[tuple[int, str]]:
    """Yield line and text of every comment."""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string.lstrip("# ")


def paragraphs(text: str) -> Iterator[tuple[int, str]]:
    """Yield first line and text of every paragraph of a document; code blocks, tables and headings are left out."""
    held: list[str] = []
    first, in_code = 1, False
    for number, line in enumerate([*text.split("\n"), ""], 1):
        fence = line.lstrip().startswith("```")
        in_code ^= fence
        item = re.match(r"\s*(?:[-*]|\d+\.)\s", line)
        if in_code or fence or not line.strip() or item or line.lstrip().startswith(("|", "#", "<", "!")):
            if held:
                yield first, "\n".join(held)
            held = []
            if not item:
                continue
        if not held:
            first = number
        held.append(line)


def findings_in(file: Path) -> Iterator[Finding]:
    """Yield the findings in a file of code or text."""
    text = file.read_text("utf-8")
    lines = text.split("\n")
    if "tests" in file.relative_to(ROOT).parts[:1]:
        yield from test_names(file, lines)
        return
    yield from avoided_words(file, lines)
    parts = paragraphs(text) if file.suffix == ".md" else [*docstrings(text), *comments(text)]
    for first, part in parts:
        yield from long_sentences(file, first, part)


def files_of(tree: str) -> list[Path]:
    """Return the files of a tree that git knows or would add."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "--", *_globs(tree)]
    names = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    return [ROOT / name for name in sorted({name for name in names if name}) if (ROOT / name).exists()]


def _globs(tree: str) -> list[str]:
    return [f":(glob){pattern}" for pattern in TREES[tree]]


def counts_of(findings: list[Finding]) -> dict[str, int]:
    """Return the number of findings of each kind."""
    return dict(sorted(Counter(finding.kind for finding in findings).items()))


def report(findings: list[Finding]) -> None:
    """Print findings, one a line."""
    for found in findings:
        print(f"{found.file.relative_to(ROOT)}:{found.line}: {found.text}: {found.advice}")


def main(arguments: list[str]) -> int:
    """Compare all trees with the baseline; return 1 where a count has risen."""
    parser = argparse.ArgumentParser(description="check the language of code and documents")
    parser.add_argument(
        "--list", choices=TREES, metavar="TREE", help=f"print all findings of a tree: {', '.join(TREES)}"
    )
    parser.add_argument("--lower", action="store_true", help="write lower counts into the baseline")
    options = parser.parse_args(arguments)
    if options.list:
        report([found for file in files_of(options.list) for found in findings_in(file)])
        return 0
    baseline: dict[str, dict[str, int]] = json.loads(BASELINE.read_text("utf-8"))
    has_risen = False
    for tree in TREES:
        findings = [found for file in files_of(tree) for found in findings_in(file)]
        counts, allowed = counts_of(findings), baseline.setdefault(tree, {})
        print(
            f"{tree}: " + ", ".join(f"{kind} {counts.get(kind, 0)} (at most {most})" for kind, most in allowed.items())
        )
        for kind in [kind for kind in counts if counts[kind] > allowed.get(kind, 0)]:
            has_risen = True
            report([found for found in findings if found.kind == kind])
            print(
                f"{tree}: {counts[kind]} findings of kind {kind}, {allowed.get(kind, 0)} allowed: reword the new ones"
            )
        baseline[tree] = {kind: min(most, counts.get(kind, 0)) for kind, most in allowed.items()}
    if options.lower:
        BASELINE.write_text(json.dumps(baseline, indent=1) + "\n", "utf-8")
    return int(has_risen)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
