"""Figures of the reference paper: those of the program."""

import os
import pickle
import shutil
import subprocess

import pytest

import arclen


def test_a_figure_and_its_files(tmp_path):
    figures = arclen.figure(9, out=tmp_path / "out", elements=40)
    assert figures.is_complete and "fig09" in figures.summary.lower() + "".join(figures.files)
    assert "<svg" in figures._repr_html_()
    assert pickle.loads(pickle.dumps(figures)).record == figures.record
    written = {path.name for path in (tmp_path / "out").rglob("*") if path.is_file()}
    assert written >= {"figures.json", "index.html"}
    if os.environ.get("ARCLEN"):
        program = shutil.which(os.environ["ARCLEN"])
        command = [program, "figure", "9", "--elements", "40", "--out", tmp_path / "o", "--quiet"]
        subprocess.run(command, check=True)
        for name, content in figures.files.items():
            assert (tmp_path / "o" / name).read_bytes() == content, name


def test_errors_are_the_programs_own():
    with pytest.raises(ValueError, match="no figure"):
        arclen.figure(99)
    with pytest.raises(ValueError, match="nothing is computed"):
        arclen.figure([1])
    with pytest.raises(TypeError):
        arclen.figure(None)
    with pytest.raises(ValueError, match="adhesoin"):
        arclen.figure(9, adhesoin=1)
