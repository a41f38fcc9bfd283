"""Tests of the benchmark's window need the packages of the extra ``window``."""

import importlib.util

import pytest

if importlib.util.find_spec("websockets") is None:
    pytest.skip("the window needs websockets, which `scripts/setup dev` installs", allow_module_level=True)
