import subprocess
import sys


def test_where_pytorch_is_missing_it_says_what_to_install() -> None:
    program = "import sys; sys.modules['torch'] = None; import voltcam_lab.torch"
    answer = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False
    )
    assert answer.returncode == 1
    assert (
        answer.stderr.splitlines()[-1]
        == "ImportError: voltcam_lab.torch takes PyTorch: pip install 'voltcam[learn]'"
    )
