"""Writes the schema of result.json from the registry of metrics: `python scripts/result_schema.py`."""

from basu.metrics.result import SCHEMA_FILE, schema_text

if __name__ == "__main__":
    SCHEMA_FILE.write_text(schema_text(), encoding="utf-8")
    print(f"wrote {SCHEMA_FILE}")
