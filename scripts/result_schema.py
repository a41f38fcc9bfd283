"""Write the schemas of result.json, series.json and matrix.json from their types: `python scripts/result_schema.py`."""

from basu.files import PACKAGE_FOLDER
from basu.output.report.document_parts import SCHEMAS, schema_text

if __name__ == "__main__":
    for name in SCHEMAS:
        path = PACKAGE_FOLDER / "data" / name
        path.write_text(schema_text(name), encoding="utf-8")
        print(f"wrote {path}")
