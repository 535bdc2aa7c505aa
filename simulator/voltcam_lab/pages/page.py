"""Reports as one self-contained HTML page: a template that extends base.html, with figures in it."""

from collections.abc import Sequence
from importlib import metadata
from pathlib import Path
from typing import Any, Literal

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from matplotlib.figure import Figure

from .style import as_uri


def render(template: str, *, title: str, subtitle: str = "", **content: Any) -> str:
    """The page of templates/`template`; text in `content` is escaped, `Markup` (as from `figure`) is not.

    Raises jinja2.UndefinedError where the template wants what `content` lacks.
    """
    version = metadata.version("voltcam")
    return _ENVIRONMENT.get_template(template).render(
        title=title, subtitle=subtitle, version=version, **content
    )


def figure(drawn: Figure, caption: str, kind: Literal["svg", "png"] = "svg") -> Markup:
    """A <figure> with the image inside the page; PNG where there are many points."""
    return Markup('<figure><img src="{}" alt="{}"><figcaption>{}</figcaption></figure>').format(
        as_uri(drawn, kind), caption, caption
    )


def table(head: Sequence[str], rows: Sequence[Sequence[object]]) -> Markup:
    """A <table>; numbers (int, float) to the right, floats to three digits, an unknown one as a dash."""
    top = Markup("").join(
        Markup('<th class="number">{}</th>' if _numeric(rows, column) else "<th>{}</th>").format(name)
        for column, name in enumerate(head)
    )
    body = Markup("").join(
        Markup("<tr>{}</tr>").format(Markup("").join(_cell(value) for value in row)) for row in rows
    )
    return Markup(
        '<div class="table"><table><thead><tr>{}</tr></thead><tbody>{}</tbody></table></div>'
    ).format(top, body)


def write(path: Path, page: str) -> None:
    """Write the page, all of it or nothing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    partial.write_text(page, encoding="utf-8")
    partial.replace(path)


def _numeric(rows: Sequence[Sequence[object]], column: int) -> bool:
    return bool(rows) and all(isinstance(row[column], int | float) for row in rows)


def _cell(value: object) -> Markup:
    if isinstance(value, float):
        text = f"{value:.3g}" if value == value else "–"
        return Markup('<td class="number">{}</td>').format(text)
    if isinstance(value, int):
        return Markup('<td class="number">{}</td>').format(value)
    return Markup("<td>{}</td>").format(value)


_ENVIRONMENT = Environment(
    loader=PackageLoader("voltcam_lab.pages"), autoescape=True, undefined=StrictUndefined,
    trim_blocks=True, lstrip_blocks=True,
)  # fmt: skip
