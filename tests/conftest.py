"""What all tests share: one hypothesis profile, repeatable and without deadlines (kernels compile on first use)."""

import os
import signal

import hypothesis

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell that starts us in the background leaves it so
    signal.signal(signal.SIGINT, signal.default_int_handler)

hypothesis.settings.register_profile("repeatable", deadline=None, derandomize=True, print_blob=True)
hypothesis.settings.register_profile("explore", deadline=None, print_blob=True, max_examples=1000)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))


def pytest_report_header() -> str:
    """Say which profile chooses the random examples; "repeatable" takes its seed from each test's own text."""
    return f"hypothesis profile: {os.environ.get('HYPOTHESIS_PROFILE', 'repeatable')}"
