"""A simulator that is not springstab's, in plain Python: runs a grid of springs or a chain and writes its frames.

foreign_run.py net|chain METHOD STEP STEPS EVERY FORMAT FOLDER
The net is 6x5 particles as `--grid 6x5 --pin first-row` has them; the chain writes K.mtx and M.mtx beside FOLDER.
"""

import math
import os
import struct
import sys

kind, method, step, steps, every, form, folder = sys.argv[1:]
h, steps, every = float(step), int(steps), int(every)
rows, columns, spacing = 6, 5, 0.025


def net():
    mass = 0.2 * spacing**2
    rest = [[j * spacing, 0.0, i * spacing] for i in range(rows) for j in range(columns)]
    springs = []
    for i in range(rows):
        for j in range(columns):
            for down, right, k in ((0, 1, 200.0), (1, 0, 200.0), (1, 1, 100.0), (1, -1, 100.0), (0, 2, 20.0), (2, 0, 20.0)):
                if i + down < rows and 0 <= j + right < columns:
                    springs.append((i * columns + j, (i + down) * columns + j + right, k,
                                    spacing * math.hypot(down, right)))

    def acceleration(x, v):
        a = [0.0] * len(x)
        for p, q, k, length in springs:
            d = [x[3 * q + c] - x[3 * p + c] for c in range(3)]
            now = math.sqrt(sum(e * e for e in d))
            for c in range(3):
                f = k * (now - length) / now * d[c] / mass
                a[3 * p + c] += f
                a[3 * q + c] -= f
        for p in range(len(x) // 3):
            a[3 * p + 1] -= 9.81
            if p < columns:
                a[3 * p:3 * p + 3] = [0.0] * 3
        return a

    return [e for p in rest for e in p], acceleration


def chain():
    n = 11
    mass = [0.5 + 0.1 * (i * 7 % 5) for i in range(n)]
    spring = [100.0 + 37.0 * (i * 5 % 7) for i in range(n + 1)]
    with open(os.path.join(os.path.dirname(folder), "K.mtx"), "w") as k:
        k.write(f"%%MatrixMarket matrix coordinate real symmetric\n{n} {n} {2 * n - 1}\n")
        for i in range(n):
            k.write(f"{i + 1} {i + 1} {spring[i] + spring[i + 1]}\n")
            if i + 1 < n:
                k.write(f"{i + 2} {i + 1} {-spring[i + 1]}\n")
    with open(os.path.join(os.path.dirname(folder), "M.mtx"), "w") as m:
        m.write(f"%%MatrixMarket matrix coordinate real symmetric\n{n} {n} {n}\n")
        m.writelines(f"{i + 1} {i + 1} {e}\n" for i, e in enumerate(mass))

    def acceleration(x, v):
        walls = [0.0, *x, 0.0]
        return [(spring[i] * (walls[i] - x[i]) + spring[i + 1] * (walls[i + 2] - x[i])) / mass[i] for i in range(n)]

    # A swing with a little of every mode in it.
    return [math.sin(math.pi * (i + 1) / (n + 1)) + 1e-7 * math.sin(9.7 * i) for i in range(n)], acceleration


def moved(a, s, b):
    return [p + s * q for p, q in zip(a, b)]


def symplectic(f, x, v):
    v = moved(v, h, f(x, v))
    return moved(x, h, v), v


def verlet(f, x, v):
    half = moved(v, h / 2, f(x, v))
    x = moved(x, h, half)
    return x, moved(half, h / 2, f(x, half))


def runge_kutta(coefficients, weights):
    def advance(f, x, v):
        slopes = []
        for c in coefficients:
            dx, dv = slopes[-1] if slopes else (v, v)
            at, speed = moved(x, c * h, dx), moved(v, c * h, dv)
            slopes.append((speed, f(at, speed)))
        for w, (dx, dv) in zip(weights, slopes):
            x, v = moved(x, w * h, dx), moved(v, w * h, dv)
        return x, v

    return advance


integrators = {
    "symplectic-euler": symplectic,
    "velocity-verlet": verlet,
    "explicit-euler": runge_kutta([0], [1]),
    "rk2": runge_kutta([0, 0.5], [0, 1]),
    "rk4": runge_kutta([0, 0.5, 0.5, 1], [1 / 6, 1 / 3, 1 / 3, 1 / 6]),
}


def write(number, x):
    path = os.path.join(folder, f"step{number}.{form}")  # no leading zeros: 2 comes before 10
    if form == "npy":
        header = f"{{'descr': '<f4', 'fortran_order': False, 'shape': ({len(x)},), }}"
        header += " " * (117 - len(header)) + "\n"
        with open(path, "wb") as out:
            out.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode())
            out.write(struct.pack(f"<{len(x)}f", *(max(min(e, 3e38), -3e38) for e in x)))
        return
    points = [f"{x[i]:.9g} {x[i + 1]:.9g} {x[i + 2]:.9g}" for i in range(0, len(x), 3)]
    with open(path, "w") as out:
        if form == "obj":
            out.writelines(f"v {p}\n" for p in points)
        else:
            out.write(f"# vtk DataFile Version 3.0\nrun\nASCII\nDATASET POLYDATA\nPOINTS {len(points)} float\n")
            out.write("\n".join(points) + "\n")


os.makedirs(folder)
x, force = net() if kind == "net" else chain()
v = [0.0] * len(x)
write(0, x)
for n in range(1, steps + 1):
    try:
        x, v = integrators[method](force, x, v)
    except OverflowError:
        x = [math.nan] * len(x)
    if n % every == 0:
        write(n // every, x)
    if not all(map(math.isfinite, x)):
        break
