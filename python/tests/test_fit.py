"""Fits and plans: those of the program."""

import json
import os
import pickle
import shutil
import subprocess

import numpy as np
import pytest

import arclen

LAB = {
    "instrument": {"spring_constant": "0.3 N/m", "spring_constant_sd": "0 %", "noise": "50 pN"},
    "shell": {"law": "hooke"},
    "physical": {"radius": "1.5 um", "radius_sd": "40 nm"},
}
LAB_FILE = """
[instrument]
spring_constant = "0.3 N/m"
spring_constant_sd = "0 %"
noise = "50 pN"
[shell]
law = "hooke"
[physical]
radius = "1.5 um"
radius_sd = "40 nm"
"""
RADIUS, YOUNG, THICKNESS, LEVER = 1.5e-6, 1.0e9, 20e-9, 0.3


def shell(end):
    return arclen.Case(
        {
            "problem": "contact",
            "shell": {"law": "hooke"},
            "physical": {
                "radius": f"{RADIUS} m",
                "young": f"{YOUNG} Pa",
                "thickness": f"{THICKNESS} m",
                "pressure": "101325 Pa",
                "adhesion": "2e-4 N/m",
                "film": "40 nm",
            },
            "mesh": {"elements": 150},
            "path": {"start": 1.12, "end": end},
            "stability": {"scan": "axisymmetric"},
        }
    )


@pytest.fixture(scope="module")
def curve():
    """A curve as a lever would measure it, with noise: an approach and a retract, 300 samples in all."""
    # points close enough for straight lines between them
    branch = shell(0.9).trace(max_step=1e-3)
    assert not branch.events.of("fold")
    force = branch["force"] * FORCE
    travel = 2 * RADIUS * (1 - branch["z0"]) + force / LEVER
    assert (np.diff(travel) > 0).all()
    down = np.linspace(travel[0], travel[-1], 150)
    segment = np.repeat(["approach", "retract"], 150)
    travel = np.concatenate([down, down[::-1]])
    pressed = np.interp(travel, branch_travel(branch), force)
    noise = np.random.default_rng(7).normal(0, 50e-12, 300)
    return {"segment": segment, "height": 9e-6 - travel, "force": pressed + noise}


CHI = YOUNG * THICKNESS
BENDING = YOUNG * THICKNESS**3 / (12 * (1 - 0.5**2))
FORCE = np.sqrt(CHI * BENDING)


def branch_travel(branch):
    return 2 * RADIUS * (1 - branch["z0"]) + branch["force"] * FORCE / LEVER


@pytest.fixture(scope="module")
def files(curve, tmp_path_factory):
    folder = tmp_path_factory.mktemp("lab")
    rows = zip(curve["segment"], curve["height"].tolist(), curve["force"].tolist())
    lines = ["segment,height_m,force_N", *(f"{s},{z!r},{f!r}" for s, z, f in rows)]
    (folder / "curve.csv").write_text("\n".join(lines) + "\n")
    (folder / "lab.toml").write_text(LAB_FILE)
    return folder


@pytest.fixture(scope="module")
def fitted(files):
    return arclen.fit(files / "curve.csv", files / "lab.toml", profile="none")


def test_a_fit_finds_the_shell(fitted):
    assert fitted.is_good and 0.7 < fitted.quality["chi2_dof"] < 1.4
    for key, truth in (("young", YOUNG), ("thickness", THICKNESS)):
        found = fitted.derived[key]
        assert abs(found.value / truth - 1) < 0.1, found
        assert abs(float(found) - truth) < 4 * found.sd
    root = fitted.derived["sqrt_chi_kb"]
    assert abs(root.value / FORCE - 1) < 0.02 and root.unit == "N"
    assert "radius" in fitted.parameters and fitted.parameters["radius"].interval95[0] < RADIUS
    with pytest.raises(KeyError, match="there are"):
        fitted.parameters["weight"]
    assert all(isinstance(text, str) for text in fitted.warnings)
    assert fitted.case.trace(elements=60).events.of("zero-force")


def test_columns_and_pictures(fitted, curve, tmp_path):
    assert fitted["force"].shape == (300,) and fitted["used"].dtype == bool
    assert np.array_equal(fitted["force"], curve["force"])
    used = fitted["used"]
    residual = fitted["force"] - fitted["model"]
    assert np.allclose(residual[used], fitted["residual"][used])
    assert fitted["residual"][used].std() == pytest.approx(50e-12, rel=0.2)
    html = fitted._repr_html_()
    assert "<svg" in html and "young" in html
    assert pickle.loads(pickle.dumps(fitted)).record == fitted.record
    fitted.save(tmp_path / "out")
    assert {"fit.json", "fit.csv", "fit.svg"} <= {
        path.name for path in (tmp_path / "out").iterdir()
    }
    pandas = pytest.importorskip("pandas")
    assert isinstance(fitted.to_pandas(), pandas.DataFrame)
    pytest.importorskip("matplotlib").use("agg")
    import matplotlib.pyplot as plt

    ax = fitted.plot(plt.figure().add_subplot())
    assert ax.get_xlabel() == "piezo [m]" and len(ax.lines) == 3


def test_arrays_and_dictionaries_give_the_same(fitted, curve):
    again = arclen.fit(curve, LAB, profile="none")
    assert again.record["parameters"] == fitted.record["parameters"]
    assert np.array_equal(again["model"], fitted["model"])
    assert again.curve == "curve-0.csv" and "curve-0.csv" in again.files["case.toml"]
    (both,) = [arclen.fit([curve], LAB, profile="none", fix=["radius"])]
    assert both[0].parameters["radius"].method == "fixed"


@pytest.mark.skipif(not os.environ.get("ARCLEN"), reason="ARCLEN is not the path of the program")
def test_the_program_finds_the_same(fitted, files):
    program = shutil.which(os.environ["ARCLEN"])
    words = ["fit", "curve.csv", "--known", "lab.toml", "--profile", "none", "--out", "o", "--json"]
    run = subprocess.run([program, *words], cwd=files, check=True, capture_output=True)
    record = json.loads(run.stdout)
    del record["files"], record["curve"]
    assert record == {key: value for key, value in fitted.record.items() if key != "curve"}
    for name, text in fitted.files.items():
        if name == "fit.csv":
            assert (files / "o" / name).read_text() == text


def test_errors_are_in_the_words_of_the_arguments(curve, files, tmp_path):
    with pytest.raises(ValueError, match="missing.csv: cannot be read"):
        arclen.fit("missing.csv", LAB)
    with pytest.raises(ValueError, match="spring_constant"):
        arclen.fit(curve, {**LAB, "instrument": {"spring_constant": "3 kg"}})
    with pytest.raises(ValueError, match="spring_konstant"):
        arclen.fit(curve, {"instrument": {"spring_konstant": "3 N/m"}})
    with pytest.raises(ValueError, match="law=NAME, or law=all") as caught:
        arclen.fit(curve, LAB | {"shell": {}})
    assert "--" not in str(caught.value)
    with pytest.raises(ValueError, match="law=rubber: must be one of"):
        arclen.fit(curve, LAB, law="rubber")
    with pytest.raises(ValueError, match="profile=weight"):
        arclen.fit(curve, LAB, profile=["weight"])
    with pytest.raises(ValueError, match="samples"):
        arclen.fit({**curve, "force": [1.0]}, LAB)
    for wrong in (3, {"force": [1.0]}, None):
        with pytest.raises(TypeError):
            arclen.fit(wrong, LAB)
    with pytest.raises(TypeError, match="known"):
        arclen.fit(curve, 3)
    results = arclen.fit(
        ["missing.csv", files / "curve.csv"], LAB, profile="none", range="1 um:9 um"
    )
    assert isinstance(results[0], ValueError) and isinstance(results[1], arclen.Fit)


def test_a_plan_is_that_of_the_program(tmp_path):
    plan = shell(0.9).plan(LAB)
    assert len(plan.depths) == 10 and plan.depths[-1]["force"] > plan.depths[0]["force"]
    sd = [depth["relative_sd"]["sqrt_chi_kb"] for depth in plan.depths]
    assert sd[-1] < sd[0] and set(plan.needed) == set(plan.depths[0]["relative_sd"])
    with pytest.raises(ValueError, match="noise: missing"):
        arclen.plan("polymer", {"instrument": {"spring_constant": "0.3 N/m"}})
    with pytest.raises(ValueError, match="contact"):
        arclen.plan("bratu", LAB)
    if os.environ.get("ARCLEN"):
        (tmp_path / "case.toml").write_text(shell(0.9).to_toml())
        (tmp_path / "lab.toml").write_text(LAB_FILE)
        words = ["fit", "--plan", "case.toml", "--known", "lab.toml", "--json"]
        program = shutil.which(os.environ["ARCLEN"])
        run = subprocess.run([program, *words], cwd=tmp_path, check=True, capture_output=True)
        assert json.loads(run.stdout)["depths"] == plan.depths


def test_a_fit_tells_how_far_it_is_and_can_be_stopped(curve):
    told = []
    whole = arclen.fit(curve, LAB, profile="none", progress=lambda *at: told.append(at) and None)
    shares = [share for _, share in told]
    assert shares == sorted(shares) and {"starts", "descents", "polish"} <= {s for s, _ in told}
    part = arclen.fit(curve, LAB, progress=lambda stage, share: stage == "polish")
    assert whole.is_good and not part.is_good
    assert any(one["code"] == "stopped" for one in part.record["warnings"])
    with pytest.raises(ValueError, match="stopped before a first shell"):
        arclen.fit(curve, LAB, progress=lambda stage, share: True)
    with pytest.raises(ZeroDivisionError):
        arclen.fit(curve, LAB, progress=lambda stage, share: 1 / 0)
    with pytest.raises(TypeError, match="progress"):
        arclen.fit(curve, LAB, progress=3)
