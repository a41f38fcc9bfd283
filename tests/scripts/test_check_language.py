"""Claims about the check of language: which lines it finds, and that counts may only fall."""

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "check_language.py"


@pytest.fixture
def check(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The script as a module, over a tree of its own in a temporary folder."""
    spec = importlib.util.spec_from_file_location("check_language", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "check_language", module)
    spec.loader.exec_module(module)
    monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(module, "BASELINE", tmp_path / "baseline.json")
    monkeypatch.setattr(module, "TREES", {"docs": ("*.md",), "src": ("*.py",)})
    monkeypatch.setattr(module, "files_of", lambda tree: sorted(tmp_path.glob("*.md" if tree == "docs" else "*.py")))
    return module


def with_baseline(folder: Path, **counts: dict[str, int]) -> None:
    (folder / "baseline.json").write_text(json.dumps(counts))


def test_a_word_to_avoid_is_printed_with_its_place_and_advice(
    check: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "page.md").write_text("One line.\nNobody is here.\n")
    with_baseline(tmp_path, docs={"words": 0})
    assert check.main([]) == 1
    assert "page.md:2: Nobody: name the thing or the role" in capsys.readouterr().out


def test_a_count_at_its_baseline_passes(check: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "page.md").write_text("Nobody is here.\n")
    with_baseline(tmp_path, docs={"words": 1})
    assert check.main([]) == 0


def test_a_part_of_a_longer_word_is_no_finding(check: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "page.md").write_text("The whole crewed house is wholly told.\n")
    with_baseline(tmp_path)
    assert check.main([]) == 0


def test_each_entry_of_a_list_of_arguments_is_a_statement_of_its_own(check: ModuleType, tmp_path: Path) -> None:
    entry = "        {}: " + " ".join(["word"] * 15) + "\n"
    text = '"""Do it.\n\n    Args:\n' + entry.format("one") + entry.format("two") + '    """\n'
    (tmp_path / "code.py").write_text("def do(one, two):\n    " + text)
    with_baseline(tmp_path)
    assert check.main([]) == 0
    (tmp_path / "code.py").write_text("def do(one, two):\n    " + text.replace("two: ", "and "))
    assert check.main([]) == 1


@pytest.mark.parametrize(("words", "fails"), [(25, 0), (26, 1)])
def test_a_sentence_has_at_most_25_words(check: ModuleType, tmp_path: Path, words: int, fails: int) -> None:
    (tmp_path / "page.md").write_text("Short one. " + " ".join(["word"] * words).capitalize() + ". Another one.\n")
    with_baseline(tmp_path)
    assert check.main([]) == fails


def test_code_tables_and_headings_of_a_document_have_no_sentences(check: ModuleType, tmp_path: Path) -> None:
    long = " ".join(["word"] * 40)
    (tmp_path / "page.md").write_text(f"# {long}\n\n| {long} |\n\n```\n{long}\n```\n")
    with_baseline(tmp_path)
    assert check.main([]) == 0


def test_docstrings_and_comments_have_sentences_and_code_has_none(check: ModuleType, tmp_path: Path) -> None:
    long = " ".join(["word"] * 40)
    (tmp_path / "module.py").write_text(f'"""{long}."""\n\nNAMES = "{long}"\n# {long}\n')
    assert [found.line for found in check.findings_in(tmp_path / "module.py")] == [1, 4]


def test_lower_never_raises_a_count(check: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "page.md").write_text("Nobody is here.\n")
    with_baseline(tmp_path, docs={"words": 3, "sentences": 0}, src={"words": 2})
    assert check.main(["--lower"]) == 0
    assert json.loads((tmp_path / "baseline.json").read_text()) == {
        "docs": {"words": 1, "sentences": 0}, "src": {"words": 0},
    }  # fmt: skip


def test_names_of_tests_are_read_word_by_word(check: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "tests").mkdir()
    file = tmp_path / "tests" / "test_some.py"
    file.write_text("def test_nobody_waits() -> None: ...\ndef test_no_client_waits() -> None: ...\n")
    assert [found.line for found in check.findings_in(file)] == [1]
