"""The code of the page docs/python.md, in order."""

import pathlib
import re

import numpy as np
import pytest

import arclen

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "python.md"


def test_the_page_runs():
    pytest.importorskip("scipy")
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.S)
    assert len(blocks) >= 8
    names = {"np": np, "arclen": arclen}
    for number, block in enumerate(blocks):
        exec(compile(block, f"{PAGE.name}, block {number}", "exec"), names)
