"""Configuration of Sphinx: ``sphinx-build --fail-on-warning docs site``; needs no network."""

import os
import subprocess
import sys
from fnmatch import fnmatch
from importlib.metadata import version as version_of
from pathlib import Path

from docutils import nodes
from jupyter_cache import get_cache
from sphinx.application import Sphinx
from sphinx.errors import SphinxError
from sphinx.writers.html5 import HTML5Translator

DOCS = Path(__file__).parent
TOOLS = DOCS / "_tools"
sys.path.insert(0, str(TOOLS))
import draw  # noqa: E402
import formulas  # noqa: E402
import lines  # noqa: E402
import outputs  # noqa: E402
import signatures  # noqa: E402

from presswear.results.provenance import program_digest  # noqa: E402

# Pages call ``presswear`` and ``python`` of the environment of the build.
os.environ["PATH"] = lines.PATH
os.environ |= {"COLUMNS": "88", "TTY_COMPATIBLE": "0"}
os.environ["PYTHONSTARTUP"] = str(TOOLS / "kernel.py")
# Pages import tests against the literature.
tests = [DOCS.parent / "tests", DOCS.parent / "tests" / "literature"]
os.environ["PYTHONPATH"] = os.pathsep.join(
    [*map(str, tests), *filter(None, [os.environ.get("PYTHONPATH")])]
)
os.environ.pop("MPLBACKEND", None)  # pages with code show their figures

project = "presswear"
author = "The presswear developers"
copyright = f"2026, {author}"
release = version = version_of("presswear")

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
    "numpydoc",
    "myst_nb",
]
exclude_patterns = ["_*", "upstream"]
templates_path = ["_templates"]
html_theme = "furo"
html_title = f"presswear {release}"
html_static_path = ["_static"]
html_extra_path = ["_outputs/paper-report.html"]
html_css_files = ["site.css"]
html_js_files = [("site.js", {"defer": "defer"})]
maximum_signature_line_length = 88
html_math_renderer = "mathml"

myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "colon_fence"]
myst_heading_anchors = 3

# Pages with code are executed once for each version of the program; a failure ends the
# build.
nb_execution_mode = "cache"
nb_execution_cache_path = str(DOCS / "_build" / f"outputs-{program_digest()}")
nb_execution_raise_on_error = True
nb_execution_in_temp = True
# Patterns of pages that are shown with their stored outputs instead of being executed
nb_execution_excludepatterns = os.environ.get("STORED_PAGES", "").split()
nb_execution_timeout = 900
nb_merge_streams = True
nb_render_markdown_format = "myst"

autosummary_generate = True
autodoc_typehints = "none"
numpydoc_show_class_members = False


def _math(self: HTML5Translator, node: nodes.math | nodes.math_block) -> None:
    """Write a formula in MathML; an unknown command ends the build."""
    is_block = isinstance(node, nodes.math_block)
    try:
        body = formulas.mathml_of(node.astext(), is_block)
    except ValueError as error:
        raise SphinxError(str(error)) from None
    self.body.append(f'<div class="formula">{body}</div>' if is_block else body)
    raise nodes.SkipNode


_COMMANDS: list[subprocess.Popen[str]] = []


def _run_commands(app: Sphinx) -> None:
    """Start the command lines of pages without cells, beside the build."""
    if app.config.nb_execution_mode == "off":
        return
    command = [sys.executable, str(TOOLS / "lines.py")]
    _COMMANDS.append(subprocess.Popen(command, stderr=subprocess.PIPE, text=True))


def _show_outputs(app: Sphinx) -> None:
    """Show the stored outputs of the pages with code that this build does not execute."""
    patterns = app.config.nb_execution_excludepatterns
    if app.config.nb_execution_mode == "off":
        patterns = ["*"]
    pages = [
        page for page in outputs.pages() if any(fnmatch(page, one) for one in patterns)
    ]
    readers = {page: ("outputs.read", {"page": page}) for page in pages}
    app.env.mystnb_config = app.env.mystnb_config.copy(custom_formats=readers)


def _check_lines(app: Sphinx, error: Exception | None) -> None:
    """End the build if a command line failed."""
    while _COMMANDS:  # Sphinx calls this again after its error
        process = _COMMANDS.pop()
        messages = process.communicate()[1]
        if process.returncode and error is None:
            raise SphinxError(messages)


def _create_outputs(app: Sphinx) -> None:
    """Create the database of outputs, because parallel processes fail if both create it."""
    _ = get_cache(app.config.nb_execution_cache_path).db


def _draw(app: Sphinx) -> None:
    """Draw the pictures of pages without code."""
    folder = DOCS / "_drawn"
    folder.mkdir(exist_ok=True)
    for name in ("restitution", "motion", "load", "blanking"):
        draw.save(name, folder)


def setup(app: Sphinx) -> None:
    """Register MathML formulas, pictures, tables and command lines."""
    app.add_html_math_renderer("mathml", (_math, None), (_math, None))
    app.connect("builder-inited", _run_commands)
    app.connect("builder-inited", _create_outputs)
    app.connect("builder-inited", _draw)
    app.connect("autodoc-process-signature", signatures.signature_of)
    app.connect("builder-inited", _show_outputs, priority=900)  # after myst-nb
    app.connect("build-finished", _check_lines)
