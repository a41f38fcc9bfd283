"""Packages of films, which are an extra of this distribution."""

from __future__ import annotations

from basu.extras import Extra

_FILM = "--film needs Playwright and PyAV: install them with `pip install 'basu-window[film]'`, or leave it out"
PLAYWRIGHT, PYAV = Extra("playwright", _FILM), Extra("av", _FILM)
