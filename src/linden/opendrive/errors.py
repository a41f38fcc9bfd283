"""What a map file can get wrong, told with the line where it stands."""

from linden.errors import UserError


class MapError(UserError):
    """An OpenDRIVE text cannot be read: which line, what stands there, what should."""

    def __init__(self, reason: str, line: int | None = None) -> None:
        super().__init__(reason if line is None else f"line {line}: {reason}")
        self.reason = reason
        self.line = line
