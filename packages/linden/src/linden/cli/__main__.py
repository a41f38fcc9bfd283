"""``python -m linden.cli``: the command ``linden`` where its script is not on the path."""

import sys

from linden.cli import main

if __name__ == "__main__":
    sys.exit(main())
