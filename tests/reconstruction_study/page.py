"""docs/how-it-works/reconstruction-study.md: the outcome, whatever it is."""

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from voltcam_lab.pages.style import save

from . import figures
from .contenders import ABLATIONS, OURS, WITHOUT, WORDS
from .figures import PUBLISHED
from .real import Real
from .results import BETTER, MEASURES, Run, ahead_by_seed, runs, separated, values

TITLES = {
    "mse": "MSE",
    "ssim": "SSIM",
    "mse_equalised": "MSE, equalised",
    "ssim_equalised": "SSIM, equalised",
}


def write(path: Path, work: Path, recordings: list[Real]) -> None:
    """The page, and its figures in a folder of its name. Raises ValueError where nothing was measured."""
    found = runs(work)
    if not found:
        raise ValueError(f"{work}: no network was measured; run the study first")
    folder = path.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    save(figures.scores(found, recordings), folder / "scores.png")
    save(figures.images(work, found, recordings), folder / "images.png")
    save(figures.losses(found), folder / "losses.png")
    path.write_text(_page(found, recordings, folder.name))


def _page(found: Sequence[Run], recordings: Sequence[Real], folder: str) -> str:
    every = list(found)
    parts = [
        _HEAD,
        f"![A dot for each network: MSE and SSIM by model and recording.]({folder}/scores.png)",
        _verdict(every, recordings),
        f"![The last frames, and what networks make of the events.]({folder}/images.png)",
        _methods(every),
        "## Every network\n\n" + "\n\n".join(_table(every, recording) for recording in recordings),
        _published(every),
        _ablation(every, recordings),
        f"## Training\n\n![Loss by training step.]({folder}/losses.png)\n\n{_budget(every)}",
        _LIMITS,
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


_HEAD = """# The reconstruction study

Written by `make study-reconstruction`; not by hand.

Networks learn to make images of simulated events, and are then given the events of a real camera.
What differs between them is whose events they learned from, and their random begin.
The paper asks the same in its Table 2 (Lin et al., ECCV 2022)."""

_LIMITS = """## What this is not

- The paper trained larger networks for longer, on other scenes, and tested on more recordings.
  Its figures stand beside these to compare the order of models, not their level.
- `davis240c` was calibrated on the same camera's recording, on the part before the one that is tested.
  No other model had that. The question is what a calibration is worth.
- The camera of `davis346_street` stands still, and most of its picture gives no events.
  No network can know what is there; its figures are mostly of a grey level that was guessed.
- The loss has no term from a network that knows photographs (LPIPS), as E2VID's has.
- Table 1 of the paper, segmentation on DDD17, needs data that is not here:
  [Train on simulated events](../how-to/learn.md#a-study-of-your-own) says what to run when one has it."""


def _verdict(found: list[Run], recordings: Sequence[Real]) -> str:
    """In words: who is best by each measure, and from whom it is set apart."""
    names = [name for name in _names(found) if name not in ABLATIONS]
    lines = ["## What came out", ""]
    for recording in recordings:
        for measure in MEASURES:
            means = {name: values(found, name, recording.name, measure).mean() for name in names}
            ranked = sorted(names, key=lambda name: means[name], reverse=BETTER[measure] is max)
            best, others = ranked[0], ranked[1:]
            asked = recording.name, measure
            by_seed = [name for name in others if ahead_by_seed(found, best, name, *asked)]
            apart = [name for name in others if separated(found, best, name, *asked)]
            ours = "" if best == OURS else f" `{OURS}` is number {ranked.index(OURS) + 1}, {means[OURS]:.4f}."
            lines.append(
                f"- {recording.name}, {TITLES[measure]}: **{best}**, {means[best]:.4f}. "
                f"Behind it with each seed: {_listed(by_seed)}; with all networks behind all of its: "
                f"{_listed(apart)}.{ours}"
            )
    return "\n".join(lines)


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in names) or "none"


def _methods(found: list[Run]) -> str:
    rows = [
        (f"`{name}`", WORDS[name], f"{_events(found, name) / 1e6:.1f}")
        for name in _names(found)
        if name in WORDS
    ]
    return (
        "## Whose events\n\n"
        "All see the same scenes: photographs that move, in linear light, clip by clip the same.\n\n"
        + _grid(("model", "is", "million events"), rows)
        + "\n\n"
        "Images are compared as they are, in 0 to 1, and equalised: every pixel's rank in its image. "
        "Events tell neither how bright a scene is nor its contrast. "
        "SSIM is that of Wang et al. (TIP 2004).\n\nRecordings: the last 40 % of `slider_depth`, and all of "
        "`davis346_street`; a network's memory settles over the ten frames before, which do not count."
    )


def _table(found: list[Run], recording: Real) -> str:
    rows = [
        (
            run.model,
            str(run.seed),
            *(f"{run.measured[recording.name][measure]:.4f}" for measure in MEASURES),
        )
        for run in found
        if run.model not in ABLATIONS
    ]
    means = [
        (
            f"**{name}**",
            "mean ± s.d.",
            *(_spread(values(found, name, recording.name, each)) for each in MEASURES),
        )
        for name in _names(found)
        if name not in ABLATIONS
    ]
    head = ("model", "seed", *(TITLES[each] for each in MEASURES))
    counted = len(recording.frames) - recording.counted
    return f"### {recording.name}, {counted} frames\n\n" + _grid(head, [*means, *rows])


def _published(found: list[Run]) -> str:
    rows = [
        (
            "DVS-Voltmeter" if name == OURS else name,
            f"{mse:.3f}",
            f"{ssim:.3f}",
            _spread(values(found, name, "slider_depth", "mse")),
            _spread(values(found, name, "slider_depth", "ssim")),
        )
        for name, (mse, ssim) in PUBLISHED.items()
        if name in _names(found)
    ]
    head = ("model", "MSE, paper", "SSIM, paper", "MSE here, slider_depth", "SSIM here, slider_depth")
    return "## Beside the paper's own figures\n\n" + _grid(head, rows)


def _ablation(found: list[Run], recordings: Sequence[Real]) -> str:
    names = [name for name in _names(found) if name in ABLATIONS]
    if not names:
        return ""
    seeds = {run.seed for run in found if run.model in names}
    same = [run for run in found if run.seed in seeds]
    asked = [(recording.name, measure) for recording in recordings for measure in MEASURES]
    rows = [
        (
            "nothing" if name == OURS else name.removeprefix(WITHOUT),
            *(_spread(values(same, name, *each)) for each in asked),
        )
        for name in (OURS, *names)
    ]
    spread = (
        "*s.d. over seeds, of nothing*",
        *(f"{values(found, OURS, *each).std(ddof=1):.4f}" for each in asked),
    )
    head = ("taken away", *(f"{TITLES[measure]}, {recording}" for recording, measure in asked))
    words = (
        f"Of the calibrated camera, with the same budget and seeds ({len(seeds)}). "
        "What differs by less than seeds do says little."
    )
    return f"## One effect less\n\n{words}\n\n{_grid(head, [*rows, spread])}"


def _budget(found: list[Run]) -> str:
    budgets = Counter(str(run.budget) for run in found)
    mixed = "" if len(budgets) == 1 else " **Networks had different budgets.**"
    one = found[0].budget
    took = np.array([run.took_s for run in found])
    machines = ", ".join(sorted({run.machine for run in found if run.machine}))
    return (
        f"{len(found)} networks, up to {max(run.seed for run in found) + 1} of a model. "
        f"FireNet's size (Scheerlinck et al., WACV 2020): 37 777 weights. "
        f"Each network had {one['steps']} steps of {one['batch']} clips, "
        f"out of {one['clips']} of {one['size']} x {one['size']} pixels, "
        f"{one['windows']} windows of 40 ms. Adam, one cycle to a rate of {one['rate']:g}.{mixed} "
        f"That took {took.min() / 60:.0f} to {took.max() / 60:.0f} minutes a network on {one['threads']} "
        f"core{'s' if one['threads'] > 1 else ''} of a machine with other work: {machines}."
    )


def _names(found: list[Run]) -> list[str]:
    return list(dict.fromkeys(run.model for run in found))


def _events(found: list[Run], name: str) -> int:
    return next(run.events for run in found if run.model == name)


def _spread(seeds: np.ndarray) -> str:
    return f"{seeds.mean():.4f} ± {seeds.std(ddof=1):.4f}" if len(seeds) > 1 else f"{seeds.mean():.4f}"


def _grid(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
