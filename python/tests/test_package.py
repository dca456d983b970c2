"""The package says what the command says; arrays have the shapes that docstrings promise."""

import dataclasses
import json
import math
import os
import signal
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.sparse

import springstab as ss

root = Path(__file__).resolve().parents[2]
command = os.environ.get("SPRINGSTAB_COMMAND", str(root / "build" / "springstab"))


def of_command(*arguments):
    done = subprocess.run([command, *arguments, "--json"], capture_output=True, text=True)
    return json.loads(done.stdout)


def chain(n, k=1e4):
    return k * scipy.sparse.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(n, n))


def numbers(value):
    """JSON has no infinity."""
    return {None: None, "inf": math.inf, "Infinity": math.inf}.get(value, value)


@pytest.mark.parametrize("scene", ["damped_cloth.json", "skirt.obj", "eyes.obj", "beam.veg"])
def test_limits_of_a_scene_are_the_commands(scene):
    path = root / "experiments" / "scenes" / scene
    ours, theirs = ss.limits(path), of_command("limits", str(path))
    assert ours.degrees_of_freedom == theirs["degrees_of_freedom"]
    assert ours.k0.value == theirs["k0"]["value"]
    assert ours.damping.kind == theirs["damping"]["kind"]
    assert list(ours) == [m["name"] for m in theirs["methods"]]
    for m in theirs["methods"]:
        mine = ours[m["name"]]
        for key in ("status", "h_max", "h_certified", "recommended_step", "h_every_pose", "h_certified_source"):
            assert getattr(mine, key) == numbers(m[key]), (m["name"], key)


def test_matrices_of_every_kind_are_one_structure():
    k, m = chain(40), scipy.sparse.diags(np.linspace(1, 3, 40))
    d = 1e-3 * k
    want = ss.limits(k.toarray(), m.toarray(), d.toarray())
    assert want.damping.kind == "rayleigh" and want.damping.alpha == pytest.approx(1e-3)
    for as_kind in (scipy.sparse.csr_matrix, scipy.sparse.coo_matrix, np.asarray):
        other = [as_kind(a.toarray()) for a in (k, m, d)]
        assert ss.limits(*other) == want


def test_symplectic_eulers_step_is_two_over_the_largest_frequency():
    k = chain(30).toarray()
    assert ss.limits(k)["symplectic-euler"].h_max == pytest.approx(2 / math.sqrt(np.linalg.eigvalsh(k)[-1]), rel=1e-9)


def test_limits_have_a_table_and_html():
    answer = ss.limits(chain(5))
    assert "symplectic-euler" in repr(answer) and repr(answer).count("\n") == len(answer) + 1
    assert answer._repr_html_().count("<tr>") == len(answer) + 1
    with pytest.raises(dataclasses.FrozenInstanceError):
        answer.safety = 2


@pytest.mark.parametrize("arguments, words", [
    (dict(K=[[1.0, 2.0], [0.0]]), "."),
    (dict(K=[[math.nan]]), "finite"),
    (dict(K=[[1.0, 0.0]]), "1 x 2, expected 1 x 1"),
    (dict(K="no such file.json"), "no such file.json"),
    (dict(K=[[1.0]], grid="2x2"), "grid is for grids"),
    (dict(K=[[1.0]], methods=["rk5"]), "rk5"),
    (dict(K=[[1.0]], max_step=-1.0), "max_step: is -1"),
    (dict(), "."),
])
def test_what_cannot_be_used_is_a_value_error(arguments, words):
    with pytest.raises(ValueError, match=words):
        ss.limits(**arguments)


def test_the_words_are_the_commands():
    done = subprocess.run([command, "limits", "no such file.json"], capture_output=True, text=True)
    with pytest.raises(ValueError) as error:
        ss.limits("no such file.json")
    assert done.stderr.strip() == "springstab: " + str(error.value)


@pytest.mark.parametrize("name", ["rk4", "symplectic-euler", "newmark:beta=0,gamma=0.5", "bdf2"])
def test_a_region_is_where_the_step_does_not_grow(name):
    region = ss.region(name)
    x, y = np.meshgrid(np.linspace(-1, 4, 21), np.linspace(-1, 9, 23))
    rho = region.spectral_radius(x, y)
    assert rho.shape == x.shape
    for at in [(3, 5), (10, 10), (20, 2)]:
        eigenvalues = np.linalg.eigvals(region.method.amplification(x[at], y[at]))
        assert rho[at] == pytest.approx(np.abs(eigenvalues).max(), rel=1e-6, abs=1e-7)
    for arc in region.boundary((-1, 4, -1, 9)):
        if arc.condition != "window":
            inner = slice(1, -1)
            assert np.allclose(region.spectral_radius(arc.x[inner], arc.y[inner]), 1, atol=1e-5)


def test_all_methods_of_the_command_are_there():
    assert {m["name"] for m in of_command("methods")["methods"]} <= {m.name for m in ss.methods()}


def test_a_run_of_one_mode_is_its_cosine():
    run = ss.simulate([[100.0]], method="rk4", duration=1.0, step=1e-3, x=[1.0], v=[0.0], frames=20)
    assert run.status == "done" and run.times.shape == (21,) and run.frames.shape == (21, 1)
    assert np.allclose(run.frames[:, 0], np.cos(10 * run.times), atol=1e-9)
    assert run.x == pytest.approx([math.cos(10)], abs=1e-9)


def test_a_run_is_the_commands():
    path = root / "experiments" / "scenes" / "damped_cloth.json"
    ours = ss.simulate(path, method="symplectic-euler", duration=0.05, frames=5)
    theirs = of_command("simulate", str(path), "--method", "symplectic-euler", "--duration", "0.05")
    assert (ours.step, ours.steps) == (theirs["step"], theirs["steps"])
    assert ours.energy[1] == theirs["energy"]["final"]
    assert ours.frames.shape[0] == 6 and ours.frames.shape[2] == 3
    assert ours.frames[-1][-1] == pytest.approx(theirs["last_particle"]["position"])
    assert max(max(face) for face in ours.faces) < ours.frames.shape[1]


def test_a_step_that_is_given_is_kept_and_divergence_said():
    run = ss.simulate([[100.0]], method="symplectic-euler", duration=100.0, step=0.3)
    assert run.diverged and run.step == pytest.approx(0.3, rel=0.01) and run.diverged_at < 100


def test_a_callback_sees_every_state_and_stops():
    seen = []

    def see(t, x, v):
        seen.append((t, x.copy(), v.copy()))
        return t < 0.5

    run = ss.simulate([[100.0]], method="rk4", duration=1.0, step=0.01, callback=see)
    assert run.status == "stopped" and run.time == pytest.approx(0.5) and len(seen) == run.steps + 1
    assert np.array_equal(seen[-1][1], run.x)


def test_what_a_callback_raises_comes_through():
    def fail(t, x, v):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        ss.simulate([[100.0]], method="rk4", duration=1.0, callback=fail)


def test_no_stable_step_is_said():
    with pytest.raises(ValueError, match="no positive step|stable"):
        ss.simulate([[100.0]], method="explicit-euler", duration=1.0)


def large():
    n = 150
    line = chain(n, 1.0)
    eye = scipy.sparse.identity(n)
    return scipy.sparse.kron(line, eye) + scipy.sparse.kron(eye, line)


def test_other_threads_run_meanwhile():
    ticks, stop = [], threading.Event()

    def tick():
        while not stop.wait(0.002):
            ticks.append(time.perf_counter())

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.perf_counter()
    ss.limits(large())
    end = time.perf_counter()
    stop.set()
    thread.join()
    inside = [t for t in ticks if begin < t < end]
    assert len(inside) > 0.1 * (end - begin) / 0.002


def test_ctrl_c_ends_it():
    k = large()
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        for _ in range(100):
            ss.limits(k)
            ss.simulate(k, method="rk4", duration=1e4)


def test_plot_region_draws_the_boundary():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    ax = ss.plot_region("rk4")
    assert ax.lines and ax.get_xlabel() and ax.get_ylabel()


@pytest.mark.parametrize("scene", ["damped_cloth.json", "beam.veg"])
def test_a_wanted_step_is_answered_as_by_the_command(scene):
    path = root / "experiments" / "scenes" / scene
    ours = ss.limits(path, for_step=2e-3, stiffest=True)
    theirs = of_command("limits", str(path), "--for-step", "2e-3")
    assert ours.for_step.keys() == theirs["for_step"].keys()
    for name, answer in ours.for_step.items():
        said = theirs["for_step"][name]
        for field in ["step", "holds", "margin", "proved", "stiffness_factor", "uniform_mass_factor", "substeps"]:
            assert getattr(answer, field) == numbers(said.get(field)), (name, field)
        assert (answer.alpha and [*answer.alpha]) == said.get("alpha"), name
        scaling, said_scaling = answer.mass_scaling, said.get("mass_scaling")
        assert (scaling is None) == (said_scaling is None)
        if scaling:
            assert scaling.proved == said_scaling["proved"]
            assert scaling.particles == {p["index"]: p["added_mass"] for p in said_scaling["particles"]}
        if answer.holds is False:
            assert answer.reasons == said.get("reasons", {})
    for one, said in zip(ours.stiffest.carriers, theirs["stiffest"], strict=True):
        assert dataclasses.asdict(one) == said
    assert ours.stiffest.nodal_bound == theirs["cheap_bounds"]["nodal"]["k0"]
    assert ours.stiffest.mode.shape == (ours.degrees_of_freedom,)


def test_sparse_matrices_may_have_any_order_and_repeat_entries():
    K = np.array([[5.0, -2.0, 0.0], [-2.0, 4.0, -1.0], [0.0, -1.0, 3.0]])
    expected = ss.limits(K)
    assert expected.symmetric and expected["symplectic-euler"].h_certified
    repeated = scipy.sparse.csc_matrix((np.repeat(K.T / 2, 2), np.tile([0, 0, 1, 1, 2, 2], 3), [0, 6, 12, 18]))
    backwards = scipy.sparse.csc_matrix((K.T[:, ::-1].ravel(), np.tile([2, 1, 0], 3), [0, 3, 6, 9]))
    before = backwards.indices.copy()
    by_diagonals = scipy.sparse.diags([np.diag(K, i) for i in (-1, 0, 1)], [-1, 0, 1])
    for same in [repeated, backwards, by_diagonals, scipy.sparse.coo_array(K), scipy.sparse.csr_matrix(K)]:
        assert (same.toarray() == K).all()
        found = ss.limits(same)
        assert found.symmetric and found.methods == expected.methods
    assert (backwards.indices == before).all()


def test_mass_scaling_of_matrices_names_the_unknowns_that_have_mass():
    K = chain(5, 1.0).toarray()
    K[3, :] *= 50
    K[:, 3] *= 50
    M = np.diag([1.0, 0.0, 1.0, 1.0, 1.0])  # unknown 1 is condensed
    answer = ss.limits(K, M, methods=["symplectic-euler"], for_step=0.2).for_step["symplectic-euler"]
    assert answer.holds is False and 3 in answer.mass_scaling.particles and 1 not in answer.mass_scaling.particles
    changed = M + np.diag([answer.mass_scaling.particles.get(i, 0.0) for i in range(5)])
    assert ss.limits(K, changed, methods=["symplectic-euler"])["symplectic-euler"].h_max >= 0.2


def test_an_error_chooses_the_cheapest_method():
    answer = ss.limits(chain(30), error=1e-3)
    assert answer.cheapest.method in answer and answer.cheapest.error <= 1e-3 and answer.cheapest.reason
    assert ss.limits(chain(30)).cheapest is None
    for error in [0.0, 1.0, math.nan]:
        with pytest.raises(ValueError, match="error: is"):
            ss.limits(chain(3), error=error)


def test_the_cells_of_the_documentation_run(tmp_path, monkeypatch, capsys):
    page = (root / "docs" / "python.md").read_text()
    cells = page.split("as cells of a notebook:\n\n```python\n")[1].split("```")[0]
    scipy.io.mmwrite(tmp_path / "K.mtx", chain(20))
    scipy.io.mmwrite(tmp_path / "M.mtx", scipy.sparse.eye(20))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    assert sum(1 for line in cells.splitlines() if line.strip()) <= 11
    exec(cells, {})
    assert "StepAnswer(step=0.0016" in capsys.readouterr().out
    assert (tmp_path / "region.png").read_bytes().startswith(b"\x89PNG")
