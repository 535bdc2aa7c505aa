"""`voltcam schema`: JSON on standard output, and a help that shows its use."""

import json

from .process import voltcam


def test_the_schema_is_json() -> None:
    assert "parameters" in json.loads(voltcam("schema").stdout)["properties"]


def test_help_reads_well() -> None:
    done = voltcam("schema", "--help")
    assert done.returncode == 0
    assert "example" in done.stdout
