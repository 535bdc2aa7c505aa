"""A small recurrent network that makes images of events, of FireNet's size.

After Scheerlinck, Rebecq, Gehrig, Barnes, Mahony, Scaramuzza, "Fast image reconstruction with an event
camera", WACV 2020: a convolution, twice a convolutional GRU and a residual block, a convolution of one pixel;
16 channels, 3 x 3 pixels. 37 777 weights with five slices of time.
"""

import torch
from torch import Tensor, nn

CHANNELS, BINS = 16, 5
State = tuple[Tensor, Tensor]


class ConvGru(nn.Module):
    """A gated recurrent unit whose matrices are convolutions (Ballas et al., ICLR 2016)."""

    def __init__(self) -> None:
        super().__init__()
        self.gates = nn.Conv2d(2 * CHANNELS, 2 * CHANNELS, 3, padding=1)
        self.candidate = nn.Conv2d(2 * CHANNELS, CHANNELS, 3, padding=1)

    def forward(self, x: Tensor, state: Tensor) -> Tensor:
        reset, update = torch.sigmoid(self.gates(torch.cat([x, state], 1))).chunk(2, 1)
        new = torch.tanh(self.candidate(torch.cat([x, reset * state], 1)))
        return state + update * (new - state)


class ResidualBlock(nn.Module):
    def __init__(self) -> None:
        super().__init__()
        self.first = nn.Conv2d(CHANNELS, CHANNELS, 3, padding=1)
        self.second = nn.Conv2d(CHANNELS, CHANNELS, 3, padding=1)

    def forward(self, x: Tensor) -> Tensor:
        return torch.relu(x + self.second(torch.relu(self.first(x))))


class FireNet(nn.Module):
    """(N, BINS, H, W) and a state in, (N, outputs, H, W) and the next state out; an image is in 0..1."""

    def __init__(self, outputs: int = 1) -> None:
        super().__init__()
        self.outputs = outputs
        self.head = nn.Conv2d(BINS, CHANNELS, 3, padding=1)
        self.memory_1, self.block_1 = ConvGru(), ResidualBlock()
        self.memory_2, self.block_2 = ConvGru(), ResidualBlock()
        self.image = nn.Conv2d(CHANNELS, outputs, 1)

    def forward(self, grid: Tensor, state: State | None = None) -> tuple[Tensor, State]:
        if state is None:
            nothing = grid.new_zeros(len(grid), CHANNELS, *grid.shape[2:])
            state = nothing, nothing
        first = self.memory_1(torch.relu(self.head(grid)), state[0])
        second = self.memory_2(self.block_1(first), state[1])
        return self.image(self.block_2(second)), (first, second)


def normalised(grid: Tensor) -> Tensor:
    """(..., BINS, H, W) with mean 0 and variance 1 over what is not 0, as E2VID has it (Rebecq et al., 2019).

    How strong events are then depends little on a model's thresholds.
    """
    seen = (grid != 0).to(grid.dtype)
    count = seen.sum(dim=(-3, -2, -1), keepdim=True).clamp(min=1)
    mean = grid.sum(dim=(-3, -2, -1), keepdim=True) / count
    spread = ((grid - mean) ** 2 * seen).sum(dim=(-3, -2, -1), keepdim=True) / count
    return (grid - mean) * seen / spread.sqrt().clamp(min=1e-3)
