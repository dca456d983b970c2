"""Integrators written here, by hand: what they can do is known, and what they are is found."""

import math

import numpy as np
import pytest

import springstab as ss

rng = np.random.default_rng(3)
n = 6
basis = np.linalg.qr(rng.normal(size=(n, n)))[0]
k = basis @ np.diag(np.linspace(10.0, 400.0, n)) @ basis.T
d = 1e-3 * k + 0.2 * np.eye(n)


def acceleration(x, v):
    return -k @ x - d @ v


def semi_implicit(x, v, h):
    v = v + h * acceleration(x, v)
    return x + h * v, v


def runge_kutta_4(x, v, h, advance=True):
    stages = []
    for c in (0, 0.5, 0.5, 1):
        dx, dv = stages[-1] if stages and advance else (0 * x, 0 * v)
        a, b = x + c * h * dx, v + c * h * dv
        stages.append((b, acceleration(a, b)))
    weights = (1 / 6, 1 / 3, 1 / 3, 1 / 6)
    return (x + h * sum(w * s[0] for w, s in zip(weights, stages)),
            v + h * sum(w * s[1] for w, s in zip(weights, stages)))


def broken_runge_kutta_4(x, v, h):
    return runge_kutta_4(x, v, h, advance=False)


def backward_euler(x, v, h):
    v = np.linalg.solve(np.eye(n) + h * d + h * h * k, v - h * k @ x)
    return x + h * v, v


rest = np.zeros(n)


@pytest.mark.parametrize("step, name", [(semi_implicit, "symplectic-euler"), (runge_kutta_4, "rk4")])
def test_a_right_integrator_has_its_methods_limit(step, name):
    found = ss.largest_stable_step(step, rest, rest, claims=name)
    want = ss.limits(k, D=d, methods=[name])[name].h_max
    assert found.h_max == pytest.approx(want, rel=1e-5)
    assert found.is_what_it_claims and found.claimed.h_max == pytest.approx(want, rel=1e-4)


def test_stages_that_are_not_advanced_are_explicit_euler():
    found = ss.largest_stable_step(broken_runge_kutta_4, rest, rest, claims="rk4")
    assert found.is_what_it_claims is False and found.method_that_fits == "explicit-euler"
    want = ss.limits(k, D=d, methods=["explicit-euler"])["explicit-euler"].h_max
    assert found.h_max == pytest.approx(want, rel=1e-5)


def test_nothing_limits_backward_euler():
    found = ss.largest_stable_step(backward_euler, rest, rest, claims="implicit-euler")
    assert found.h_max == math.inf and found.is_what_it_claims


def test_explicit_euler_has_no_step_on_undamped_motion():
    found = ss.largest_stable_step(lambda x, v, h: (x + h * v, v - h * (k @ x)), rest, rest)
    assert found.h_max is None


def test_rigid_motions_do_not_count():
    free = 100.0 * np.array([[1.0, -1.0], [-1.0, 1.0]])

    def step(x, v, h):
        v = v - h * free @ x
        return x + h * v, v

    found = ss.largest_stable_step(step, [0.0, 1e-9], [0.0, 0.0], claims="symplectic-euler")
    assert found.h_max == pytest.approx(2 / math.sqrt(200.0), rel=1e-5) and found.is_what_it_claims


def chain_xpbd(x, v, h, substeps=4, compliance=1e-3, mass=0.1):
    """Particles on a line, distance constraints solved once, in order, each substep (Macklin et al. 2016)."""
    dt = h / substeps
    for _ in range(substeps):
        predicted = x + dt * v
        for i in range(len(x)):
            left = predicted[i - 1] if i else 0.0
            c = predicted[i] - left - 1.0
            weight = (2.0 if i else 1.0) / mass + compliance / dt**2
            push = -c / weight / mass
            predicted[i] += push
            if i:
                predicted[i - 1] -= push
        v = (predicted - x) / dt
        x = predicted
    return x, v


def test_xpbd_with_substeps_is_no_method_of_the_list_and_has_a_limit_or_none():
    rest_chain = np.arange(1.0, 6.0)
    found = ss.largest_stable_step(chain_xpbd, rest_chain, 0 * rest_chain, claims="implicit-euler")
    assert found.is_what_it_claims is False and found.method_that_fits is None
    # What it says holds in a run: a small disturbance stays small at a tenth of the limit.
    h = 0.1 * min(found.h_max, 1.0)
    x, v = rest_chain + 1e-3 * rng.normal(size=5), 0 * rest_chain
    for _ in range(2000):
        x, v = chain_xpbd(x, v, h)
    assert np.abs(x - rest_chain).max() < 1e-2


def test_what_the_step_raises_comes_through():
    def fail(x, v, h):
        raise RuntimeError("mine")

    with pytest.raises(RuntimeError, match="mine"):
        ss.largest_stable_step(fail, [0.0], [0.0])


@pytest.mark.parametrize("step, words", [
    (lambda x, v, h: (x[:1], v), "entries"),
    (lambda x, v, h: x, "."),
])
def test_what_is_no_step_is_refused(step, words):
    with pytest.raises((ValueError, RuntimeError, TypeError), match=words):
        ss.largest_stable_step(step, [0.0, 1.0], [0.0, 0.0])


def test_a_step_that_gives_nan_is_never_stable():
    with pytest.raises(ValueError, match="not finite"):
        ss.largest_stable_step(lambda x, v, h: (x * math.nan, v), [0.0], [0.0])
