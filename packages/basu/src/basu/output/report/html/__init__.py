"""``report.html``: one file that shows a run and why it scored as it did; it opens offline and asks no network."""
