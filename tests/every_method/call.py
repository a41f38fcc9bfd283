"""What a row of a table is: a small call, or one that the client itself is known not to manage."""

from collections.abc import Callable
from typing import NamedTuple

from every_method.stage import Stage


class Defect(NamedTuple):
    """A call that the client itself cannot do, against whatever server."""

    call: Callable[[Stage], object]
    raises: str
    """Name of the exception's class, or of one that it is derived from."""
    because: str


Call = Callable[[Stage], object] | Defect
"""Returns None where nothing comes back, True where what came back is plausible."""
