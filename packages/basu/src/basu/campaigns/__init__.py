"""Campaigns: one file states a question, jobs are made of it, workers drive them, a table holds a row for each drive.

- `settings` reads the file, and `plan` makes jobs of it.
- `player` drives a job in a worker; `command` runs all of them.
- `columns`, `drive_table` and `records` keep what came of them.
- `intervals`, `looks`, `conclusions` and `report` say what may be concluded.
"""
