"""`voltcam convert`: a help that shows its use. What it does is tested in `test_convert`."""

from .process import voltcam


def test_help_reads_well() -> None:
    done = voltcam("convert", "--help")
    assert done.returncode == 0
    assert "example" in done.stdout
    assert ".npz" in done.stdout
