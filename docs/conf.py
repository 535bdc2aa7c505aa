"""How the site is made of these pages: `make docs`."""

import sys
from importlib import metadata
from pathlib import Path
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx

sys.path.insert(0, str(Path(__file__).parent))
import from_code

project = "Voltcam"
copyright = "Voltcam's authors, Apache 2.0"
release = metadata.version("voltcam")
html_title = f"Voltcam {release}"

extensions = ["myst_parser", "sphinx.ext.autodoc"]
autodoc_mock_imports = ["torch"]  # not in [docs]: it is large
nitpicky = True
# Names in our signatures that have no entry here: other libraries', and effects, which have a page of theirs.
nitpick_ignore_regex = [
    ("py:.*", r"(np|npt|numpy|torch|pydantic|collections|pathlib|typing|argparse|zmq)\..*"),
    ("py:.*", r"voltcam_simulator\.effects?\..*"),
    ("py:.*", r"voltcam_client\.camera\.Message"),
    ("py:.*", r"voltcam_video\.frame\.Frame"),
    ("py:.*", r"voltcam_simulator\.fixed_pattern\.FixedPattern"),
    ("py:.*", r"voltcam_simulator\.simulator\.Drawn"),
]

# Markdown as a forge shows it: headings are anchors, formulas stand between dollars.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

default_role = "literal"  # of docstrings: `name` is code there, too
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
python_use_unqualified_type_names = True

html_theme = "furo"
html_favicon = "../server/voltcam_server/web/icon.svg"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_copy_source = False


def fill(_: Sphinx, __: str, source: list[str]) -> None:
    """Put what the code says where a page asks for it."""
    source[0] = from_code.filled(source[0])


def formula(display: str) -> Any:
    """Formulas as MathML, which browsers show by themselves: no script, nothing from elsewhere."""

    def visit(translator: Any, node: nodes.Element) -> None:
        translator.body.append(convert(node.astext(), display=display))
        raise nodes.SkipNode

    return visit, None


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.connect("source-read", fill)
    app.add_html_math_renderer("mathml", formula("inline"), formula("block"))
