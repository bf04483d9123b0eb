"""Makes docs/gallery.md from the notebooks: runs them, and shows what each is about with its last picture.

``python gallery.py`` needs nbclient, ipykernel, matplotlib and distributed.
"""

import base64
import pathlib

NOTEBOOKS = sorted(pathlib.Path(__file__).parent.glob("*.ipynb"))
DOCS = pathlib.Path(__file__).parents[2] / "docs"
HEAD = """# Gallery

Five short notebooks of the [Python package](python.md); `python/notebooks/gallery.py` makes this page from them.
"""
SMALL = """%matplotlib inline
import matplotlib
matplotlib.rcParams["figure.dpi"] = 72"""


def picture(path):
    """The file name of a notebook's picture."""
    return f"gallery-{path.stem.partition('-')[0]}.png"


def page(read):
    """The page; `read` reads a notebook."""
    text = HEAD
    for path in NOTEBOOKS:
        first = read(path).cells[0].source
        title, _, about = first.removeprefix("# ").partition("\n\n")
        text += f"\n## {title}\n\n{about}\n\n"
        text += f"![{title}]({picture(path)})\n\n[{path.name}](../python/notebooks/{path.name})\n"
    return text


def main():
    import nbclient
    import nbformat

    def read(path):
        return nbformat.read(path, 4)

    for path in NOTEBOOKS:
        notebook = read(path)
        notebook.cells.insert(0, nbformat.v4.new_code_cell(SMALL))
        nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3").execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        images = [output["data"].get("image/png") for output in outputs if "data" in output]
        *_, last = filter(None, images)
        (DOCS / picture(path)).write_bytes(base64.b64decode(last))
    (DOCS / "gallery.md").write_text(page(read), "utf-8")


if __name__ == "__main__":
    main()
