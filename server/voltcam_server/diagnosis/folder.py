"""The folders of a daemon's diagnoses: made, and tidied up when they are over."""

import contextlib
import itertools
import os
import shutil
import tempfile
from pathlib import Path

from voltcam_simulator import Camera

from ..problems import UsageError, one_line

FOLDER, REPORT = "voltcam-diagnosis-", "report.html"
START = "start.yaml"
"""The camera that a diagnosis begins from."""
GATHERED = "gathered.npz"
"""What was gathered of a stream."""
_NUMBERS = itertools.count(1)
"""Of the cameras of this process, one that was removed included: an object's `id` may come again."""


class DiagnosisFolders:
    """Those of one camera's diagnoses, below `work`, or where temporary files are. They are left there."""

    def __init__(self, work: Path | None) -> None:
        self._work = work
        # No other camera's, and no other daemon's.
        self._prefix = f"{FOLDER}{os.getpid()}-{next(_NUMBERS)}-"

    def make(self, camera: Camera) -> Path:
        """A new one, with the camera in it. Raises UsageError."""
        try:
            folder = Path(tempfile.mkdtemp(prefix=self._prefix, dir=self._work))
            (folder / START).write_text(camera.to_yaml())
        except OSError as error:
            raise UsageError(f"no folder for the diagnosis: {one_line(error)}: set TMPDIR") from None
        return folder

    def tidy_up(self) -> None:
        """Remove folders of diagnoses that are over, or where there is a report, the large things in them.

        Also those of daemons that are gone, which may have been killed.
        """
        root = self._work or Path(tempfile.gettempdir())
        for folder in root.glob(f"{FOLDER}*"):
            pid = folder.name.removeprefix(FOLDER).partition("-")[0]
            if folder.name.startswith(self._prefix) or not Path("/proc", pid).exists():
                _thin_out(folder)


def _thin_out(folder: Path) -> None:
    if not (folder / REPORT).exists():
        shutil.rmtree(folder, ignore_errors=True)
        return
    with contextlib.suppress(OSError):  # it is not ours alone
        for path in folder.iterdir():
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            elif path.name == GATHERED:
                path.unlink()
