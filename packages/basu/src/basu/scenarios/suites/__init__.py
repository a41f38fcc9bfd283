"""Suites of cases by a standard: requirements as files, the cases that test them, and what records say about them."""
