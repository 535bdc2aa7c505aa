"""One network on one contender's clips; it goes on where it was interrupted."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from torch import Tensor
from torch.nn import functional

from .clips import Clips
from .network import FireNet, normalised

SETTLING = 2  # windows at a clip's begin of which nothing is asked
KEPT_EVERY = 50
SIMILAR = 0.3  # weight of 1 - SSIM beside the absolute error


Loss = Callable[[Tensor, Tensor], Tensor]
"""(what the network made (N, outputs, H, W), what was wanted (N, 1, H, W)) -> a number."""


@dataclass(frozen=True)
class Budget:
    """The same for all: steps of `batch` clips."""

    steps: int = 300
    batch: int = 2
    rate: float = 2e-3


@dataclass(frozen=True)
class Trained:
    """losses: of each step. took_s: in training, over all runs of the command."""

    network: FireNet
    losses: list[float]
    took_s: float


def trained(
    clips: Clips, budget: Budget, seed: int, kept: Path, loss_of: Loss | None = None, outputs: int = 1
) -> Trained:
    """From random weights by the seed; clips come in an order by the seed. loss_of: of a window."""
    torch.manual_seed(seed)
    network = FireNet(outputs).to(memory_format=torch.channels_last)
    optimiser = torch.optim.Adam(network.parameters(), lr=budget.rate)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, budget.rate, total_steps=budget.steps)
    losses: list[float] = []
    took_s = 0.0
    if kept.exists():
        saved: dict[str, Any] = torch.load(kept, weights_only=True)
        network.load_state_dict(saved["network"])
        optimiser.load_state_dict(saved["optimiser"])
        schedule.load_state_dict(saved["schedule"])
        losses, took_s = saved["losses"], saved["took_s"]
    order = _order(len(clips.grids), budget, seed)
    began_s = time.monotonic()
    for step in range(len(losses), budget.steps):
        chosen = order[step]
        grids, images = clips.grids[chosen].float(), clips.images[chosen].float()
        if int(chosen.sum()) % 2:  # mirrored, half of the time
            grids, images = grids.flip(-1), images.flip(-1)
        loss = _loss(network, normalised(grids), images, loss_of or image_loss)
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimiser.step()
        schedule.step()
        losses.append(loss.item())
        if len(losses) % KEPT_EVERY == 0 or len(losses) == budget.steps:
            state = {
                "network": network.state_dict(),
                "optimiser": optimiser.state_dict(),
                "schedule": schedule.state_dict(),
                "losses": losses,
                "took_s": took_s + time.monotonic() - began_s,
            }
            kept.parent.mkdir(parents=True, exist_ok=True)
            torch.save(state, aside := kept.with_suffix(".partial"))
            aside.replace(kept)
    return Trained(network.eval(), losses, took_s + time.monotonic() - began_s)


def _order(count: int, budget: Budget, seed: int) -> Tensor:
    """Which clips each step takes, (steps, batch): every clip once before any comes again."""
    generator = torch.Generator().manual_seed(seed)
    rounds = -(-budget.steps * budget.batch // count)
    every = torch.cat([torch.randperm(count, generator=generator) for _ in range(rounds)])
    return every[: budget.steps * budget.batch].reshape(budget.steps, budget.batch)


def _loss(network: FireNet, grids: Tensor, images: Tensor, loss_of: Loss) -> Tensor:
    """Over the windows of clips. grids: (N, T, BINS, H, W); images: (N, T, H, W)."""
    state, total = None, grids.new_zeros(())
    windows = grids.shape[1]
    for window in range(windows):
        made, state = network(grids[:, window].contiguous(memory_format=torch.channels_last), state)
        if window >= SETTLING:
            total = total + loss_of(made, images[:, window, None])
    return total / (windows - SETTLING)


def image_loss(made: Tensor, wanted: Tensor) -> Tensor:
    """Absolute error and 1 - SSIM."""
    return (made - wanted).abs().mean() + SIMILAR * (1 - _similarity(made, wanted))


def _similarity(a: Tensor, b: Tensor) -> Tensor:
    """SSIM with a flat window of 7 x 7 pixels, which costs little."""

    def local(values: Tensor) -> Tensor:
        return functional.avg_pool2d(values, 7, stride=1)

    mean_a, mean_b = local(a), local(b)
    var_a, var_b = local(a * a) - mean_a**2, local(b * b) - mean_b**2
    both = local(a * b) - mean_a * mean_b
    same = (2 * mean_a * mean_b + 1e-4) * (2 * both + 9e-4)
    return (same / ((mean_a**2 + mean_b**2 + 1e-4) * (var_a + var_b + 9e-4))).mean()
