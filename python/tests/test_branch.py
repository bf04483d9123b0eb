"""What a branch offers: columns, points, files, pictures."""

import pickle
import time

import numpy as np
import pytest

import arclen


@pytest.fixture
def branch(cusp):
    return cusp.trace("mu", [-1.5], [-2, 1], 2)


def test_a_column_is_there_at_once(cusp):
    times = []
    for _ in range(20):
        branch = cusp.trace("mu", [-1.5], [-2, 1], 2)
        start = time.perf_counter()
        branch["x"]
        times.append(time.perf_counter() - start)
    assert min(times) < 10e-6, times


def test_the_critical_mode_is_there(branch, pitchfork):
    fold = branch.events.of("LP")[0]
    assert np.array_equal(branch.shape(fold), fold.modes[0]) and fold.modes[0].shape == (1,)
    trunk = pitchfork.trace("p", [0], [-1], 1)
    assert np.array_equal(np.abs(trunk.shape(trunk.events[0])), [1.0])
    for wrong in (trunk.events[0], branch[0], None):
        with pytest.raises(TypeError):
            branch.shape(wrong)


def test_columns_are_cached_and_read_only(branch):
    assert branch.columns == ["mu", "x", "s", "dp_ds", "unstable", "certified"]
    assert branch["x"] is branch["x"] and branch["x"].dtype == np.float64
    assert np.array_equal(branch["u[0]"], branch["x"])
    with pytest.raises(ValueError, match="read-only"):
        branch["x"][0] = 1
    with pytest.raises(KeyError, match="there are mu, x"):
        branch["force"]
    assert "x" in branch and "force" not in branch and "u[1]" not in branch


def test_a_column_takes_less_than_ten_microseconds(branch):
    branch["x"]
    start = time.perf_counter()
    for _ in range(10_000):
        branch["x"]
    assert (time.perf_counter() - start) / 10_000 < 10e-6


def test_points(branch):
    assert len(branch) == len(list(branch)) == branch.states.shape[0]
    last = branch[-1]
    assert (last.p, last.index, last["x"]) == (2.0, len(branch) - 1, branch["x"][-1])
    assert np.array_equal(last.u, branch.u(-1)) and np.array_equal(branch.states[-1], last.u)
    assert last.unstable == 0 and last.certified
    with pytest.raises(IndexError):
        branch[len(branch)]
    with pytest.raises(TypeError):
        branch[1.5]
    with pytest.raises(TypeError):
        branch[1:2]


def test_states_belong_to_the_caller(branch):
    branch.u(0)[0] = 7.0
    assert branch.u(0)[0] != 7.0


def test_pickled_and_saved_branches_are_equal(branch, cusp, tmp_path):
    assert pickle.loads(pickle.dumps(branch)) == branch
    branch.save(tmp_path / "half.arclen")
    loaded = arclen.Branch.load(tmp_path / "half.arclen")
    assert loaded == branch and np.array_equal(loaded["x"], branch["x"])
    assert [repr(event) for event in loaded.events] == [repr(event) for event in branch.events]
    assert cusp.restart(loaded, target=3)["mu"][-1] == 3.0
    assert [p.name for p in tmp_path.iterdir()] == ["half.arclen"]


def test_other_files_are_no_branches(branch, tmp_path):
    path = tmp_path / "file"
    branch.save(path)
    whole = path.read_bytes()
    for content in (b"", b"text", whole[:100], whole[:-1], b"arclen branch\n[]\n" + b"\x82\x01"):
        path.write_bytes(content)
        with pytest.raises(ValueError, match="holds no branch"):
            arclen.Branch.load(path)


def test_csv_is_exact(branch, tmp_path):
    branch.to_csv(tmp_path / "branch.csv")
    text = (tmp_path / "branch.csv").read_text()
    assert text == branch.to_csv()
    lines = [line.split(",") for line in text.splitlines()]
    at = lines[0].index("mu")
    assert np.array_equal([float(line[at]) for line in lines[1:]], branch["mu"])


def test_events(branch):
    events = branch.events
    assert len(events) == 2 and events[-1] is list(events)[1] and len(events[:1]) == 1
    assert events.of("fold") == events.of("LP") and events.of("hopf") == []
    event = events[0]
    assert isinstance(event, arclen.Point) and event.branch is branch
    assert branch["mu"][event.index] == event.p
    assert 0 <= event.error_estimate < 1e-8 and event.residual < 1e-9
    assert repr(event).startswith("<Event LP: fold at mu = 0.3849")


def test_notebooks_get_a_picture_and_a_table(branch, pitchfork):
    html = branch._repr_html_()
    assert html.count("<svg") == 1 and html.count("LP") == 4 and "stroke-dasharray" in html
    diagram = pitchfork.diagram("p", [0], [-1], target=1)
    assert diagram._repr_html_().count("<polyline") == 4
    assert repr(diagram) == "<Diagram of 3 branches, 1 branch points>"


def test_pandas(branch):
    pytest.importorskip("pandas")
    table = branch.to_pandas()
    assert list(table.columns) == [*branch.columns, "event"]
    assert list(table["event"][table["event"] != ""]) == ["fold", "fold"]
    assert np.array_equal(table["x"].to_numpy(), branch["x"])


def test_matplotlib(branch, pitchfork):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    ax = branch.plot(Figure().subplots())
    dashed = [line.get_linestyle() for line in ax.lines if len(line.get_xdata()) > 1]
    assert dashed == ["-", "--", "-"]
    assert [text.get_text() for text in ax.texts] == ["LP", "LP"]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("mu", "x")
    diagram = pitchfork.diagram("p", [0], [-1], target=1)
    assert len(diagram.plot(Figure().subplots()).lines) > 4
