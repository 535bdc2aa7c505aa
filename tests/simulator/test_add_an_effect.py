"""docs/how-to/add-an-effect.md, followed to the letter on a copy of the package."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import voltcam_simulator

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "add-an-effect.md"


def test_the_page_adds_an_effect(tmp_path: Path) -> None:
    effect, import_line, registry_line, test = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
    package = tmp_path / "voltcam_simulator"
    shutil.copytree(Path(voltcam_simulator.__file__).parent, package)
    (package / "effects" / "saturation.py").write_text(effect)
    registry = package / "effects" / "__init__.py"
    text = registry.read_text()
    text = text.replace("from .temperature_drift", import_line + "from .temperature_drift")
    text = text.replace("    ContrastResponse,\n", registry_line + "    ContrastResponse,\n")
    assert import_line in text
    assert registry_line in text
    registry.write_text(text)
    (tmp_path / "test_saturation.py").write_text(test)
    answer = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_saturation.py"],
        cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300,
        env=os.environ | {"PYTHONPATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")},
    )  # fmt: skip
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "1 passed" in answer.stdout
