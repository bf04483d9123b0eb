"""SciPy's matrices, patterns, and large problems."""

import numpy as np
import pytest
from conftest import bratu

import arclen

sp = pytest.importorskip("scipy.sparse")


def chain(n):
    f, _ = bratu(n)
    h2 = 1.0 / (n + 1) ** 2
    second = sp.diags([np.ones(n - 1), np.full(n, -2.0), np.ones(n - 1)], [-1, 0, 1]) / h2
    second = second.tocsr()

    def jac(u, p):
        return second + sp.diags(p[0] * np.exp(u))

    return f, jac


def square(m):
    """Bratu's problem on a square of m × m cells."""
    h2 = 1.0 / (m + 1) ** 2
    line = sp.diags([np.ones(m - 1), np.full(m, -2.0), np.ones(m - 1)], [-1, 0, 1])
    plane = (sp.kron(line, sp.eye(m)) + sp.kron(sp.eye(m), line)).tocsr() / h2
    f = lambda u, p: plane @ u + p[0] * np.exp(u)
    return f, lambda u, p: plane + sp.diags(p[0] * np.exp(u))


@pytest.mark.parametrize("form", ["csr", "csc", "coo", "lil", "dia", "array"])
def test_every_format_gives_the_dense_branch(form):
    n = 30
    f, jac = chain(n)
    convert = sp.csr_array if form == "array" else lambda m: m.asformat(form)
    sparse = arclen.Problem(f, ["p"], jac=lambda u, p: convert(jac(u, p)))
    dense = arclen.Problem(f, ["p"], jac=lambda u, p: jac(u, p).toarray())
    folds = [
        problem.trace("p", np.zeros(n), [0.0], domain=(0, 5), max_points=60).events.of("LP")
        for problem in (sparse, dense)
    ]
    assert abs(folds[0][0].p - folds[1][0].p) < 1e-10
    assert sparse._engine(np.zeros(n), np.zeros(1)).storage == "band"


def test_a_plane_is_sparse_and_its_fold_is_known():
    m = 32
    f, jac = square(m)
    problem = arclen.Problem(
        f, ["p"], jac=jac, stability=None, observe={"top": lambda u, p: u.max()}
    )
    branch = problem.trace("p", np.zeros(m * m), [0.0], stop_at={"top": 3.0})
    assert problem._engine(np.zeros(m * m), np.zeros(1)).storage == "sparse"
    (fold,) = branch.events.of("LP")
    # 6.808124 for the square, less the error of second order of the mesh
    assert abs(fold.p - 6.808124423) < 0.02


def test_differences_with_a_pattern_equal_the_jacobian():
    m = 10
    f, jac = square(m)
    pattern = jac(np.zeros(m * m), [1.0])
    by_pattern = arclen.Problem(f, ["p"], sparsity=pattern, stability=None)
    exact = arclen.Problem(f, ["p"], jac=jac, stability=None)
    ends = [one.trace("p", np.zeros(m * m), [0.0], 5.0).u(-1) for one in (by_pattern, exact)]
    assert abs(ends[0] - ends[1]).max() < 1e-9
    dense = arclen.Problem(f, ["p"], sparsity=pattern.toarray() != 0, stability=None)
    assert abs(dense.trace("p", np.zeros(m * m), [0.0], 5.0).u(-1) - ends[1]).max() < 1e-9


def test_a_pattern_that_grows_on_the_way():
    # at u = 0 the coupling is zero, and SciPy drops it
    def f(u, p):
        return np.array([u[0] - p[0] + u[1] ** 2, u[1] - p[0] + u[0] * u[2], u[2] - u[0] ** 2])

    def jac(u, p):
        full = np.array([[1, 2 * u[1], 0], [u[2], 1, u[0]], [-2 * u[0], 0, 1]])
        return sp.csr_matrix(full)

    problem = arclen.Problem(f, ["p"], jac=jac)
    branch = problem.trace("p", np.zeros(3), [0.0], 0.2)
    expected = arclen.Problem(f, ["p"]).trace("p", np.zeros(3), [0.0], 0.2)
    assert branch.stopped_because == "target"
    assert np.allclose(branch.u(-1), expected.u(-1), atol=1e-10)
    strict = arclen.Problem(f, ["p"], jac=jac, sparsity=sp.eye(3))
    with pytest.raises(ValueError, match=r"entry \(\d, \d\), which is not in `sparsity`"):
        strict.trace("p", np.zeros(3), [0.0], 0.2)


def test_a_sparse_mass_matrix_is_part_of_the_pattern():
    # M = [[1, 1], [0, 1]], f = −u: λ M x = −x, both eigenvalues −1
    mass = sp.csr_matrix(np.array([[1.0, 1.0], [0.0, 1.0]]))
    problem = arclen.Problem(
        lambda u, p: p[0] - u, ["p"], jac=lambda u, p: -sp.eye(2), mass=mass, stability="dynamics"
    )
    assert np.allclose(problem.modes([0, 0], [0], 2)[0], [-1, -1])
    branch = problem.trace("p", [0, 0], [0], 1)
    assert (branch["unstable"] == 0).all()


def test_12800_unknowns():
    n = 12_800
    f, jac = chain(n)
    problem = arclen.Problem(
        f, ["p"], jac=jac, stability=None, observe={"top": lambda u, p: u.max()}
    )
    branch = problem.trace("p", np.zeros(n), [0.0], stop_at={"top": 3.0})
    (fold,) = branch.events.of("LP")
    assert abs(fold.p - 3.513830719) < 1e-6
    assert branch.states.shape == (len(branch), n)


def test_sparse_hopf_points_and_their_curve():
    # Brusselators side by side, of which one has another parameter
    n = 60
    others = np.linspace(0.1, 0.5, n // 2)

    def rates(u, p):
        level = others.copy()
        level[0] = p[0]
        return u[0::2], u[1::2], level

    def f(u, p):
        x, y, level = rates(u, p)
        r = np.empty(n)
        r[0::2] = p[1] - (level + 1) * x + x * x * y
        r[1::2] = level * x - x * x * y
        return r

    def jac(u, p):
        x, y, level = rates(u, p)
        blocks = [
            np.array([[-(c + 1) + 2 * a * d, a * a], [c - 2 * a * d, -a * a]])
            for a, d, c in zip(x, y, level)
        ]
        return sp.block_diag(blocks, format="csc")

    def slope(u, p):
        columns = np.zeros((n, 2))
        columns[:2, 0] = -u[0], u[0]
        columns[0::2, 1] = 1
        return columns

    problem = arclen.Problem(f, ["B", "A"], jac=jac, parameter_derivative=slope)
    start = np.empty(n)
    start[0::2], start[1::2] = 1.0, others
    start[1] = 1.0
    branch = problem.trace("B", start, [1, 1], 3)
    (hopf,) = branch.events.of("H")
    assert abs(hopf.p - 2) < 1e-10
    curve = problem.curve(hopf, "A", domain=(0.8, 1.2), max_step=0.2)
    assert (curve["A"].min(), curve["A"].max()) == (0.8, 1.2)
    assert abs(curve["B"] - 1 - curve["A"] ** 2).max() < 1e-8
