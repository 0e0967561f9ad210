"""Write docs/scenario.schema.json from the types that scenario files are checked with."""

import json
from pathlib import Path

from beliefnest.scenarios.json_schema import schema

if __name__ == "__main__":
    target = Path(__file__).parents[1] / "docs" / "scenario.schema.json"
    target.write_text(json.dumps(schema(), indent=2) + "\n", encoding="utf-8")
