"""Packages of the viewer and of films, which are extras of this distribution."""

from __future__ import annotations

from basu.extras import Extra

RERUN = Extra("rerun", "--viewer needs Rerun: install it with `pip install 'basu-window[viewer]'`, or leave it out")
_FILM = "--film needs Playwright and PyAV: install them with `pip install 'basu-window[film]'`, or leave it out"
PLAYWRIGHT, PYAV = Extra("playwright", _FILM), Extra("av", _FILM)
