"""Claim: the code of the page has the types that its comments say. TypeScript reads them; users do not need it."""

import json
import subprocess
from pathlib import Path

import pytest

TYPESCRIPT = Path(__file__).parents[3] / ".venv" / "typescript" / "node_modules"
PAGE = Path(__file__).parents[1] / "src" / "linden_window" / "page"


def test_types_of_the_page(tmp_path: Path) -> None:
    compiler = TYPESCRIPT / ".bin" / "tsc"
    if not compiler.exists():
        pytest.skip("there is no TypeScript; `scripts/setup dev` installs it where npm is")
    types = TYPESCRIPT / "@types" / "three"
    settings = {
        "compilerOptions": {
            "allowJs": True,
            "checkJs": True,
            "noEmit": True,
            "strict": True,
            "target": "ES2023",
            "module": "ESNext",
            "moduleResolution": "bundler",
            "lib": ["ES2023", "DOM", "DOM.Iterable"],
            "skipLibCheck": True,
            "types": [],
            "paths": {"three": [str(types)], "three/addons/*": [f"{types}/examples/jsm/*"]},
        },
        "include": [f"{PAGE}/*.js"],
    }
    (tmp_path / "tsconfig.json").write_text(json.dumps(settings))
    done = subprocess.run([compiler, "-p", tmp_path], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "")
    assert all("// @ts-check" in file.read_text() for file in PAGE.glob("*.js"))


def test_three_is_the_version_that_its_note_names() -> None:
    revision = (PAGE / "three" / "VERSION.txt").read_text().split()[1].split(".")[1]
    assert f"const REVISION = '{revision}'" in (PAGE / "three" / "three.core.js").read_text()
    assert "MIT License" in (PAGE / "three" / "LICENSE.txt").read_text()
