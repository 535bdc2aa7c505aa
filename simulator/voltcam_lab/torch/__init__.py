"""Events for training, simulated in the loader's workers: nothing is stored.

clips = EventClips(Photographs("photographs"), "davis346", width=128, height=128, windows=20, seed=1)
loader = torch.utils.data.DataLoader(clips, batch_size=4, num_workers=2)
"""

try:
    import torch  # noqa: F401
except ImportError as error:  # where it is missing, one line says what to install
    raise ImportError("voltcam_lab.torch takes PyTorch: pip install 'voltcam[learn]'") from error

from .clip import ClipShape, Representation, WindowedClip
from .clips import EventClips
from .recorded import RecordedClips
from .scenery import Photographs, Scenery, Videos

__all__ = [
    "ClipShape",
    "EventClips",
    "Photographs",
    "RecordedClips",
    "Representation",
    "Scenery",
    "Videos",
    "WindowedClip",
]
