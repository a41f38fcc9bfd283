"""Complete the documentation site with the decision pages: in the menu and on their index (a hook of mkdocs)."""

from __future__ import annotations

from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

INDEX = "decisions/index.md"


def decision_pages(config: MkDocsConfig) -> list[Path]:
    """Return the decision pages in the order of their numbers."""
    return sorted((Path(config.docs_dir) / "decisions").glob("0*.md"))


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """List all decision pages in the menu, below their index."""
    for section in config.nav or []:
        for entries in section.values():
            if isinstance(entries, list) and {"Decisions": INDEX} in entries:
                pages = [f"decisions/{path.name}" for path in decision_pages(config)]
                entries[entries.index({"Decisions": INDEX})] = {"Decisions": [INDEX, *pages]}
                return config
    raise SystemExit(f"mkdocs.yml has no entry 'Decisions: {INDEX}'; the decision pages hang below it")


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Return the text of a page; the index of the decisions gets a list of all of them."""
    del files
    if page.file.src_uri != INDEX:
        return markdown
    rows = [f"| {path.name[:4]} | [{title(path)}]({path.name}) |" for path in decision_pages(config)]
    return "\n".join([markdown, "| number | decision |", "|---|---|", *rows, ""])


def title(path: Path) -> str:
    """Return the heading of a page, without the number that some have."""
    heading = path.read_text("utf-8").splitlines()[0].removeprefix("# ")
    return heading.removeprefix(f"{path.name[:4]}: ").replace("|", "\\|")
