"""Three coupled pendulums, stepped by Runge-Kutta 4: what `springstab probe` asks a program for, in Python."""

import json
import sys


def acceleration(x, v):
    left, right = [0.0, *x[:-1]], [*x[1:], 0.0]
    return [400 * (a - 2 * b + c) - 10 * b - 0.1 * w for a, b, c, w in zip(left, x, right, v)]


def moved(a, s, b):
    return [p + s * q for p, q in zip(a, b)]


def step(h, x, v):
    k1 = (v, acceleration(x, v))
    k2 = (moved(v, h / 2, k1[1]), acceleration(moved(x, h / 2, k1[0]), moved(v, h / 2, k1[1])))
    k3 = (moved(v, h / 2, k2[1]), acceleration(moved(x, h / 2, k2[0]), moved(v, h / 2, k2[1])))
    k4 = (moved(v, h, k3[1]), acceleration(moved(x, h, k3[0]), moved(v, h, k3[1])))
    for k, weight in ((k1, 1), (k2, 2), (k3, 2), (k4, 1)):
        x, v = moved(x, h * weight / 6, k[0]), moved(v, h * weight / 6, k[1])
    return x, v


for line in sys.stdin:
    state = json.loads(line)
    x, v = step(state["h"], state["x"], state["v"])
    print(json.dumps({"x": x, "v": v}), flush=True)
