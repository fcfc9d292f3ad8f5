"""Sphinx's configuration: `make docs` builds this folder into build/site, where every warning is an error."""

import re
import sys
from importlib import metadata
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = "humanoid-sot"
author = "The humanoid-sot authors"
copyright = f"{author}, Apache 2.0"
try:
    release = metadata.version(project)
except metadata.PackageNotFoundError:
    release = ""

extensions = [
    "mathml",
    "mermaid",
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
]

# Pages
myst_enable_extensions = ["attrs_inline", "colon_fence", "dollarmath"]
myst_fence_as_directive = ["mermaid"]
myst_heading_anchors = 3
copybutton_prompt_text = r"^(?:\$|>>>) "
copybutton_prompt_is_regexp = True

# Notebooks are run while the site is built: the repository has no output of theirs, and what the page shows is true.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 600  # s a cell, on a busy machine

# The reference is made from the docstrings, which are plain text with `code` in single quotes.
default_role = "code"
autodoc_default_options = {
    "members": True,
    "imported-members": True,  # of a package: what its __all__ names
    "show-inheritance": True,
    "member-order": "bysource",
}
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
add_module_names = False
python_maximum_signature_line_length = 88
napoleon_numpy_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

# Looks
html_theme = "furo"
html_math_renderer = "mathml"
html_title = "humanoid-sot " + release.partition("+")[0]  # without the commit of a version between two tags
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False


def titles_for_links(app: Any, page: str, source: list[str]) -> None:
    """Links that show a page's file name, for whoever reads the file, show its title on the site."""
    source[0] = re.sub(r"\[(?:docs/)?([\w-]+\.md)\]\(((?:[\w./-]*/)?\1)\)", r"[](\2)", source[0])


def examples_as_sections(app: Any, page: str, source: list[str]) -> None:
    """Links to an example's file lead to its section of the page of examples, instead of downloading it."""
    source[0] = re.sub(r"\]\(examples/(\w+)\.py\)", lambda link: f"](examples.md#{link[1]}py)", source[0])


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.connect("source-read", titles_for_links)
    app.connect("source-read", examples_as_sections)
