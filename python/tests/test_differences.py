"""Derivatives by the parameter without a function for them."""

import numpy as np
import pytest

import arclen

FUNCTIONS = {
    "affine": (lambda u, p: p[0] * np.exp(u) - 2 * u, True),
    "affine with a large constant": (lambda u, p: 1e3 * p[0] - u, True),
    "a square": (lambda u, p: p[0] ** 2 - u, False),
    "a cube about zero": (lambda u, p: p[0] ** 3 + p[0] - u - u**3, False),
    "almost affine": (lambda u, p: p[0] + 1e-9 * p[0] ** 2 - u, False),
    "periodic": (lambda u, p: np.sin(4 * np.pi * p[0]) + p[0] - u, False),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_few_residuals_where_a_parameter_is_affine(name):
    f, is_affine = FUNCTIONS[name]
    calls = []

    def counted(u, p):
        calls.append(p[0])
        return f(u, p)

    jac = lambda u, p: np.diag((f(u + 1e-30j, p)).imag * 1e30)
    problem = arclen.Problem(counted, ["p"], jac=jac, stability=None)
    branch = problem.trace("p", [0.1], [0.1], domain=(0, 0.5), max_points=30)
    assert len(branch) > 3
    per_iteration = len(calls) / branch.statistics["newton_iterations"]
    assert (per_iteration < 12) == is_affine, per_iteration
    # against differences over other steps
    for point in branch:
        assert problem.check(point.u, [point.p])["parameters"]["p"] < 1e-8
