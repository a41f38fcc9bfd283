"""The page of the thesis has a row for each of its sections; other tests check the files and commands it names."""

import re

from docs.pages import ROOT

CONTENTS = (
    "1.1 1.2 1.3 1.4 2.1 2.2 2.3 2.4 2.5 2.6 2.6.1 2.6.2 2.6.3 3.1 3.2 3.2.1 3.2.2 3.2.3 3.2.4 3.2.5 "
    "4.1 4.1.1 4.1.2 4.1.3 4.1.4 4.1.5 4.1.6 4.1.7 4.1.8 4.1.9 4.2 4.2.1 4.2.2 4.2.3 4.2.4 4.3 4.3.1 4.3.2 "
    "4.4 4.4.1 4.4.2 4.4.3 4.5 5.1 5.2 5.2.1 5.2.2 5.2.3 5.2.4 5.3 5.4 5.5 6.1 6.2 6.3 A.1 A.2 B.1 B.2 C.1 C.2"
)
SECTIONS = CONTENTS.split()
WITHOUT_WORK = {"1.3", "1.4", "6.3"}  # the thesis's own outline and last words


def rows() -> dict[str, str]:
    found: dict[str, str] = {}
    for section, where in re.findall(
        r"^\| ([\dABC.]+) \|[^|]*\| (.*?) ?\|$", (ROOT / "docs/thesis.md").read_text("utf-8"), re.MULTILINE
    ):
        found[section] = found.get(section, "") + where
    return found


def test_each_section_has_a_row_and_no_other() -> None:
    assert sorted(rows()) == sorted(SECTIONS)


def test_each_row_names_a_file_a_page_or_a_command_or_says_not_built() -> None:
    empty = [section for section, where in rows().items() if "`" not in where and "](" not in where]
    assert not [section for section in empty if "not built" not in rows()[section] and section not in WITHOUT_WORK]
