"""Scenario files agree with the JSON Schema, as an editor sees them."""

import json
from pathlib import Path

import jsonschema
import pytest
import yaml

ROOT = Path(__file__).parents[2]
# the files in planner/ are planning instances, in formats of their own
SCENARIOS = sorted(path for path in (ROOT / "scenarios").glob("**/*.yaml") if path.parent.name != "planner")
# each breaks a rule that the schema knows: type, range, name or required key
BAD = [
    "dropout_above_one",
    "empty_waypoints",
    "flat_rectangle",
    "missing_mass",
    "name_with_slash",
    "negative_mass",
    "no_goal",
    "randomize_one_end",
    "rate_zero",
    "slope_91",
    "too_many_robots",
    "two_controllers",
    "two_corners",
    "type_quoted_number",
    "unknown_key",
    "unknown_world",
]


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    schema = json.loads((ROOT / "scenarios" / "scenario.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_scenarios_of_the_repository_satisfy_the_schema(validator, path):
    validator.validate(yaml.safe_load(path.read_text()))


@pytest.mark.parametrize("name", BAD)
def test_bad_scenarios_violate_the_schema(validator, name):
    text = (ROOT / "tests" / "bad" / f"{name}.yaml").read_text()
    assert list(validator.iter_errors(yaml.safe_load(text)))


def test_every_key_is_described(validator):
    def undescribed(schema, name):
        for key, value in schema.get("properties", {}).items():
            target = validator.schema["$defs"].get(value.get("$ref", "").rpartition("/")[2], {})
            if "description" not in value and "description" not in target:
                yield f"{name}.{key}"

    schema = validator.schema
    missing = list(undescribed(schema, "")) + [
        key for name, part in schema["$defs"].items() for key in undescribed(part, name)
    ]
    assert missing == []
