"""Complete the navigation of the documentation site with the decision pages (a hook of mkdocs)."""

from __future__ import annotations

from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig

INDEX = "decisions/index.md"


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """List all decision pages below their index."""
    pages = sorted(path.name for path in (Path(config.docs_dir) / "decisions").glob("0*.md"))
    for section in config.nav or []:
        for entries in section.values():
            if isinstance(entries, list) and {"Decisions": INDEX} in entries:
                entries[entries.index({"Decisions": INDEX})] = {
                    "Decisions": [INDEX, *(f"decisions/{name}" for name in pages)]
                }
                return config
    raise SystemExit(f"mkdocs.yml has no entry 'Decisions: {INDEX}'; the decision pages hang below it")
