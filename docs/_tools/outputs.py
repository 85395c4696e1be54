"""Outputs of the pages with code, for builds of the site without execution.

    sphinx-build docs site && python docs/_tools/outputs.py
    sphinx-build -D nb_execution_mode=off docs site

The first line executes the pages, stores the cells with their outputs in
``docs/_outputs``, and writes the tables of README.md and results.md; the second one
shows the cells.
"""

import base64
import io
from pathlib import Path
from typing import Any

import columns
import nbformat
import readme
from myst_nb.core.read import read_myst_markdown_notebook
from PIL import Image
from sphinx.errors import SphinxError

DOCS = Path(__file__).resolve().parents[1]
FOLDER = DOCS / "_outputs"
EXECUTED = DOCS.parent / "jupyter_execute"  # written by myst-nb beside the site
PICTURE = "image/png"
COLOURS = 64  # of a stored picture


def pages() -> list[str]:
    """Return the files of the pages with code, relative to ``docs``."""
    names = []
    for page in DOCS.rglob("*.md"):
        if "_build" not in page.parts and "file_format: mystnb" in page.read_text():
            names.append(str(page.relative_to(DOCS)))
    return sorted(names)


def stored_file(page: str) -> Path:
    """Return the notebook with the stored outputs of a page."""
    return FOLDER / page.replace("/", "-").replace(".md", ".ipynb")


def cells_of(notebook: Any) -> list[Any]:
    """Return the cells with code of a notebook."""
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def read(text: str, page: str) -> Any:
    """Return a page as a notebook with its stored outputs, for myst-nb.

    Raises
    ------
    SphinxError
        If the code of the page is not that of the stored outputs.
    """
    notebook = read_myst_markdown_notebook(text, add_source_map=True, path=page)
    cells = cells_of(notebook)
    stored = nbformat.read(stored_file(page), 4)
    if [cell.source for cell in cells] != [cell.source for cell in stored.cells]:
        raise SphinxError(
            f"{page}: its code has changed; execute it and run docs/_tools/outputs.py"
        )
    for cell, executed in zip(cells, stored.cells, strict=True):
        cell.outputs = executed.outputs
        cell.execution_count = executed.execution_count
    notebook.metadata.language_info = {"name": "python", "pygments_lexer": "ipython3"}
    return notebook


def _smaller(picture: str) -> str:
    """Return a picture, base64 as in a notebook, with few colours."""
    with Image.open(io.BytesIO(base64.b64decode(picture))) as image:
        quantized = image.convert("RGB").quantize(COLOURS)
    data = io.BytesIO()
    quantized.save(data, "png", optimize=True)
    return base64.b64encode(data.getvalue()).decode()


def store(page: str) -> None:
    """Store the executed cells of a page."""
    notebook = nbformat.read((EXECUTED / page).with_suffix(".ipynb"), 4)
    notebook.cells = cells_of(notebook)
    notebook.metadata = {}
    notebook.nbformat_minor = 4  # from 4.5 on cells have random names
    for cell in notebook.cells:
        cell.metadata = {}
        cell.pop("id", None)
        for output in cell.outputs:
            if PICTURE in output.get("data", {}):
                output.data[PICTURE] = _smaller(output.data[PICTURE])
    FOLDER.mkdir(exist_ok=True)
    nbformat.write(notebook, stored_file(page))


if __name__ == "__main__":
    for name in pages():
        store(name)
    readme.fill()
    columns.fill()
