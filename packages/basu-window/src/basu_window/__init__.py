"""A window on a run: the page of the browser, and a person at the wheel."""
