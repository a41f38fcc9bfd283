"""Reports of runs, comparisons and scenarios: console tables, HTML pages, pictures, and JSON and JUnit documents."""
