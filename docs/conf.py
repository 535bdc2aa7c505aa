"""How the site is made of these pages: `make docs`."""

project = "Voltcam"
copyright = "Voltcam's authors, Apache 2.0"
html_title = "Voltcam"

extensions = ["myst_parser", "sphinx.ext.autodoc"]
exclude_patterns = ["_build"]
nitpicky = True

# Markdown as a forge shows it: headings are anchors, formulas stand between dollars.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

html_theme = "furo"
