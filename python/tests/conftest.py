"""Problems with known answers."""

import signal

import numpy as np
import pytest

import arclen

# a shell's job in the background ignores these, and so would all that the tests start
signal.signal(signal.SIGINT, signal.default_int_handler)
for name in ("SIGHUP", "SIGTERM"):
    if hasattr(signal, name):
        signal.signal(getattr(signal, name), signal.SIG_DFL)


def bratu(n):
    """u'' + p eᵘ = 0 on (0, 1), u = 0 at both ends, by differences: f and ∂f/∂u."""
    h2 = 1.0 / (n + 1) ** 2
    second = (
        (np.diag(np.full(n, -2.0)) + np.eye(n, k=1) + np.eye(n, k=-1)) / h2 if n < 500 else None
    )

    def f(u, p):
        r = np.empty_like(u)
        r[1:-1] = u[:-2] - 2 * u[1:-1] + u[2:]
        r[0] = u[1] - 2 * u[0]
        r[-1] = u[-2] - 2 * u[-1]
        return r / h2 + p[0] * np.exp(u)

    def jac(u, p):
        return second + np.diag(p[0] * np.exp(u))

    return f, jac


@pytest.fixture
def pitchfork():
    return arclen.Problem(lambda u, p: p[0] * u - u**3, ["p"], observe={"x": lambda u, p: u[0]})


@pytest.fixture
def cusp():
    """μ + λx − x³: a fold for every λ > 0, a cusp at 0."""

    def f(u, p):
        mu, lam = p
        return mu + lam * u - u**3

    return arclen.Problem(f, ["mu", "lambda"], observe={"x": lambda u, p: u[0]})


@pytest.fixture
def brusselator():
    def f(u, p):
        x, y = u
        a, b = p
        return [a - (b + 1) * x + x * x * y, b * x - x * x * y]

    return arclen.Problem(f, ["A", "B"], stability="dynamics")
