"""docs/how-to/add-an-effect.md, followed to the letter on a copy of the repository."""

from pathlib import Path

from voltcam_client.formats import read

from .follow import follow


def test_the_page_adds_an_effect(tmp_path: Path) -> None:
    page = follow("how-to/add-an-effect.md", tmp_path)
    own_test, schema, use, named = page.commands
    assert "1 passed" in page.run(own_test)
    page.run(schema)
    assert '"limit_dn"' in (tmp_path / "docs" / "voltcam.schema.json").read_text()
    page.run(use)
    page.run(use.replace("dim.csv", "bright.csv").replace("limit_dn=100", "limit_dn=1e6"))
    dim, bright = (read(tmp_path / name).events.size for name in ("dim.csv", "bright.csv"))
    assert 0 < dim < bright
    assert "1 passed" in page.run(named)
