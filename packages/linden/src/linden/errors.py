"""The errors a person reads, drawn as a tree.

::

    LindenError
    ├── UserError       the person at the command line can mend it: a sentence and what to do next
    ├── Refusal         a client asked for something that cannot be; the text reaches it word for word
    └── ProtocolError   the peer does not speak the protocol; its connection is closed

Anything else that is raised is a bug of ours: it is logged with its traceback and never shown as the user's fault.
"""


class LindenError(Exception):
    """Base of all errors that carry a sentence for a reader."""


class UserError(LindenError):
    """What was typed or given cannot be used: says which, why, and what to do next."""


class Refusal(LindenError):  # noqa: N818 - the word CARLA's users know; an answer, not a fault
    """A client's call is refused; the official client raises ``RuntimeError`` with this text word for word."""


class ProtocolError(LindenError):
    """The bytes of a peer are not what the protocol allows; says what was found and what was expected."""
