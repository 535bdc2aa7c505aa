"""What workers of the tests do with an item."""

import os
import signal
import time
from pathlib import Path

from voltcam_server.dataset.clips import Item
from voltcam_server.dataset.item import ItemOutcome, Making, make_item


def items(count: int) -> list[Item]:
    from voltcam_server.dataset.clips import InputClip

    return [Item(InputClip(f"clip{i}", Path(f"clip{i}")), 0, i, f"items/clip{i}", "") for i in range(count)]


def done(item: Item) -> ItemOutcome:
    return ItemOutcome(item, {"name": item.clip.name, "pid": os.getpid()})


def dies_once(item: Item, marks: Path) -> ItemOutcome:
    """The worker of the third is killed, the first time."""
    mark = marks / item.clip.name
    if item.seed == 2 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return done(item)


def dies(item: Item) -> ItemOutcome:
    """Each worker of the third."""
    time.sleep(0.1)  # others are under way then, or wait
    if item.seed == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return done(item)


def make_and_die_once(item: Item, making: Making, marks: Path, name: str) -> ItemOutcome:
    """The worker of one clip is killed with a part of its item aside, the first time."""
    mark = marks / name
    if item.clip.name == name and not mark.exists():
        aside = making.out / ".aside" / "half"
        aside.mkdir(parents=True)
        (aside / Path(item.path).name).write_bytes(b"half")
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return make_item(item, making)
