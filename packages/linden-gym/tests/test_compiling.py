"""Claims about `linden compile` with this plugin: it compiles the kernels of environments."""

from linden.cli.compiling import compile_groups
from linden_gym import following


def test_linden_compile_has_the_kernels_of_environments() -> None:
    compile_groups(["environments"])
    assert following.locate.signatures  # type: ignore[attr-defined] # numba's own
    assert following.judge.signatures  # type: ignore[attr-defined] # numba's own
