"""The notebooks run from top to bottom."""

import pathlib

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
pytest.importorskip("matplotlib")

NOTEBOOKS = sorted((pathlib.Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))


def test_there_are_five_without_outputs():
    assert len(NOTEBOOKS) == 5
    for path in NOTEBOOKS:
        for cell in nbformat.read(path, 4).cells:
            assert not cell.get("outputs") and cell.get("execution_count") is None, path


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path):
    notebook = nbformat.read(path, 4)
    if any("distributed" in cell.source for cell in notebook.cells):
        pytest.importorskip("distributed")
    options = {"resources": {"metadata": {"path": tmp_path}}}
    client = nbclient.NotebookClient(notebook, timeout=240, kernel_name="python3", **options)
    client.execute()
    shown = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in shown)


def test_the_gallery_is_made_from_them():
    import runpy

    made = runpy.run_path(str(NOTEBOOKS[0].with_name("gallery.py")))
    page = made["page"](lambda path: nbformat.read(path, 4))
    assert (made["DOCS"] / "gallery.md").read_text("utf-8") == page
    assert all((made["DOCS"] / made["picture"](path)).exists() for path in NOTEBOOKS)
