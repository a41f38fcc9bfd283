"""The package of the viewer, which is an extra of this distribution."""

from __future__ import annotations

from basu.extras import Extra

RERUN = Extra("rerun", "--viewer needs Rerun: install it with `pip install 'basu-window[viewer]'`, or leave it out")
