#!/usr/bin/env python3
"""Hard cases of `dyn stress` through MuJoCo, as far as it can express them, beside libdyn's in one run.

    python bench/stress_mujoco.py [--dyn build/release/bin/dyn] [NAME ...]

Needs the package mujoco. Errors are in the metric of the case; steps are 1 ms, integrator RK4 where nothing touches, elliptic
cones, defaults otherwise. Prints a table in Markdown.
"""

import argparse
import json
import math
import subprocess

import mujoco
import numpy as np

G = 9.81


def model(body, options="", gravity=(0, 0, -G), dt=1e-3, integrator="RK4", rest=""):
    text = f'<mujoco><compiler angle="radian" inertiafromgeom="false"/><option timestep="{dt}" integrator="{integrator}" cone="elliptic" gravity="{gravity[0]} {gravity[1]} {gravity[2]}" {options}/>'
    m = mujoco.MjModel.from_xml_string(f"{text}<worldbody>{body}</worldbody>{rest}</mujoco>")
    return m, mujoco.MjData(m)


def run(m, d, duration):
    for _ in range(round(duration / m.opt.timestep)):
        mujoco.mj_step(m, d)
    if d.warning[mujoco.mjtWarning.mjWARN_BADQACC].number or not np.all(np.isfinite(d.qpos)):
        return False
    return True


def inertial(mass, com, I):
    I = [max(x, 1e-9) for x in I]
    return f'<inertial pos="{com[0]} {com[1]} {com[2]}" mass="{mass}" diaginertia="{I[0]} {I[1]} {I[2]}"/>'


def links(n):
    text = ""
    for k in reversed(range(n)):
        text = f'<body pos="0 0 {-1 if k else 0}"><joint axis="0 -1 0"/>{inertial(1, (0, 0, -1), (0, 0, 0))}{text}</body>'
    return text


def pendulum():
    m, d = model(links(1))
    d.qpos[0] = math.pi / 2
    run(m, d, 2000)
    return max(abs(math.sin(d.qpos[0]) + 0.81460306858903215), abs(-math.cos(d.qpos[0]) + 0.58001882783693546))


def double_pendulum(duration, reference):
    m, d = model(links(2))
    d.qpos[0] = math.pi / 2
    run(m, d, duration)
    q, v = d.qpos, d.qvel
    return float(np.max(np.abs(np.array([q[0], q[0] + q[1], v[0], v[0] + v[1]]) - reference)))


def attitude(q, reference):
    q = np.array(q) * (1 if np.dot(q, reference) > 0 else -1)
    return float(np.max(np.abs(q - reference)))


BOX = inertial(10, (0, 0, 0), (10 * (0.16 + 0.81) / 12, 10 * (0.01 + 0.81) / 12, 10 * (0.01 + 0.16) / 12))


def box_complex(duration, reference):
    m, d = model(f"<body><freejoint/>{BOX}</body>", gravity=(0, 0, -9.8))
    d.qvel[:] = (-2, 2, 8, 0.1, 5, 0.1)
    run(m, d, duration)
    return attitude(d.qpos[3:7], reference)


def box_invariants():
    m, d = model(f"<body><freejoint/>{BOX}</body>", gravity=(0, 0, 0))
    d.qvel[3:] = (0.1, 5, 0.1)
    I, w = m.body_inertia[1], d.qvel[3:]
    size = lambda: np.array([np.dot(I * w, w), np.linalg.norm(I * w)])
    first = size()
    run(m, d, 1000)
    return float(np.max(np.abs(size() / first - 1)))


def heavy_top(duration, reference):
    m, d = model(f'<body><joint type="ball"/>{inertial(15, (0, 1, 0), (0.234375, 0.46875, 0.234375))}</body>')
    d.qvel[:] = (0, 150, -4.61538)
    run(m, d, duration)
    mujoco.mj_forward(m, d)
    return float(np.max(np.abs(d.xipos[1] - reference)))


def bricard():
    P = np.array([(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)], float)
    axes = ("0 1 0", "0 0 1", "1 0 0", "0 1 0", "0 0 1")
    text = ""
    for k in reversed(range(5)):
        along, before = P[k + 1] - P[k], P[k] - P[k - 1] if k else np.zeros(3)
        I = (1 - along**2) / 12
        text = f'<body name="b{k}" pos="{before[0]} {before[1]} {before[2]}"><joint axis="{axes[k]}"/>{inertial(1, along / 2, I)}{text}</body>'
    ties = "".join(f'<connect body1="b4" anchor="{a}" solref="2e-3 1" solimp=".9999 .9999 .001"/>' for a in ("-1 0 0", "0 0 0"))
    m, d = model(text, gravity=(0, -G, 0), integrator="implicit", rest=f"<equality>{ties}</equality>")
    run(m, d, 10)
    mujoco.mj_forward(m, d)
    return float(np.max(np.abs(d.xpos[4] - (0.999999729401917775, -1.00073538991051202, 0.999264339690327738))))


def box(name, mass, size, at, friction):
    return (f'<body name="{name}" pos="{at[0]} {at[1]} {at[2]}"><freejoint/><inertial pos="0 0 0" mass="{mass}" '
            f'diaginertia="{mass * (size[1]**2 + size[2]**2) / 12} {mass * (size[0]**2 + size[2]**2) / 12} {mass * (size[0]**2 + size[1]**2) / 12}"/><geom type="box" size="{size[0] / 2} {size[1] / 2} {size[2] / 2}" friction="{friction} 0 0" condim="3"/></body>')


def plane(friction=0.0):
    return f'<geom type="plane" size="50 50 1" friction="{friction} 0 0" condim="3"/>'


def stack_penetration():
    worst = 0.0
    for masses in ((1, 1), (1, 1e3), (1, 1e6), (1e-3, 1e3), (1e3, 1e-3), (1e6, 1)):
        m, d = model(plane() + "".join(box(f"b{k}", x, (0.2, 0.2, 0.2), (0, 0, 0.1 + 0.2 * k), 0.6)
                                       for k, x in enumerate(masses)), integrator="Euler")
        for _ in range(1000):
            mujoco.mj_step(m, d)
            if d.ncon:
                worst = max(worst, -d.contact.dist.min())
            worst = max(worst, 0.1 - d.qpos[2])
    return float(worst)


def on_incline(mu, angle, v=0.0):
    m, d = model(plane() + box("b", 1, (0.2, 0.2, 0.1), (0, 0, 0.05), mu), gravity=(G * math.sin(angle), 0, -G * math.cos(angle)),
                 integrator="Euler")
    d.qvel[0] = v
    return m, d


def incline_sticks():
    worst = 0.0
    for mu in (0.1, 0.5, 1.0):
        for share in (0.5, 0.9, 0.99, 0.999):
            m, d = on_incline(mu, share * math.atan(mu))
            run(m, d, 3)
            worst = max(worst, abs(d.qvel[0]))
    return worst


def incline_slides():
    worst = 0.0
    for mu in (0.1, 0.5, 1.0):
        for share in (1.001, 1.01, 1.1):
            angle = share * math.atan(mu)
            m, d = on_incline(mu, angle)
            run(m, d, 3)
            worst = max(worst, abs(d.qvel[0] - 3 * G * (math.sin(angle) - mu * math.cos(angle))))
    return worst


def block_stops():
    m, d = on_incline(0.4, 0, 1)
    run(m, d, 0.3)
    return abs(d.qpos[0] - 0.12742099898)


def sphere():
    m, d = model(plane() + '<body pos="0 0 .1"><freejoint/><inertial pos="0 0 0" mass="1" diaginertia=".004 .004 .004"/><geom '
                           'size=".1" friction=".2 0 0" condim="3"/></body>', integrator="Euler")
    d.qvel[0] = 1
    run(m, d, 0.5)
    return d


def sphere_rolls():
    t = 2 / (7 * 0.2 * G)
    return abs(sphere().qpos[0] - (t - 0.1 * G * t * t + 5 / 7 * (0.5 - t)))


def isotropy():
    far = []
    for k in range(64):
        m, d = on_incline(0.4, 0)
        d.qvel[:2] = math.cos(2 * math.pi * k / 64), math.sin(2 * math.pi * k / 64)
        run(m, d, 0.3)
        far.append(math.hypot(*d.qpos[:2]))
    return (max(far) - min(far)) / max(far)


def four_bar_spring():
    """The parallelogram on its diagonal spring, stiff connects: angle and rate after ten periods."""
    base, k, A = 2.0, 100.0, 5 / 3
    slack, at = math.sqrt(5), lambda x: math.sqrt(base**2 + 1 + 2 * base * math.cos(x))
    first = math.pi / 2 - 0.8
    last = math.acos(((2 * slack - at(first)) ** 2 - base**2 - 1) / (2 * base))
    s = math.pi * ((np.arange(256) + 0.5) / 256 - 0.5)
    U = lambda x: k / 2 * (np.sqrt(base**2 + 1 + 2 * base * np.cos(x)) - slack) ** 2
    half, angle = (last - first) / 2, (first + last) / 2 + (last - first) / 2 * np.sin(s)
    period = float(np.sum(2 * math.pi / 256 * half * np.cos(s) / np.sqrt(2 * (U(np.array(first)) - U(angle)) / A)))
    rod = lambda name, at, length, rest="": f'<body name="{name}" pos="{at} 0 0"><joint axis="0 0 1"/>{inertial(1, (length / 2, 0, 0), (0, length**2 / 12, length**2 / 12))}{rest}</body>'
    coupler = rod("coupler", 1, base, f'<site name="far" pos="{base} 0 0"/>')
    rest = (f'<tendon><spatial stiffness="{k}" springlength="{slack}"><site site="near"/><site site="far"/></spatial></tendon>'
            f'<equality><connect body1="coupler" body2="right" anchor="{base} 0 0" solref="2e-3 1" solimp=".9999 .9999 '
            '.001"/></equality>')
    # as it is at angle 0: flat
    m, d = model('<site name="near"/>' + rod("left", 0, 1, coupler) + rod("right", base, 1), gravity=(0, 0, 0),
                 dt=period / round(period / 1e-3), rest=rest)
    d.qpos[:] = first, -first, first
    run(m, d, 10 * period)
    return float(max(abs(d.qpos[0] - first), abs(d.qvel[0]) * period / (2 * math.pi)))


def table_least():
    a, b, mass, height, foot, worst = 0.5, 0.3, 12, 0.7, 0.02, 0.0
    for x, y in ((0, 0), (0.1, 0.05), (-0.2, 0.08), (0.25, -0.1)):
        feet = "".join(f'<geom size="{foot}" pos="{i * a} {j * b} {foot - height}" friction=".5 0 0" condim="3"/>'
                       for i in (-1, 1) for j in (-1, 1))
        I = [mass / 12 * t for t in (4 * b * b + 0.0025, 4 * a * a + 0.0025, 4 * a * a + 4 * b * b)]
        m, d = model(plane() + f'<body pos="0 0 {height}"><freejoint/>{inertial(mass, (x, y, 0), I)}{feet}</body>',
                     integrator="Euler")
        run(m, d, 3)
        force, expected = np.zeros(6), {(i, j): (1 + i * x / a + j * y / b) / 4 for i in (-1, 1) for j in (-1, 1)}
        for k in range(d.ncon):
            mujoco.mj_contactForce(m, d, k, force)
            corner = tuple(int(math.copysign(1, v)) for v in d.contact[k].pos[:2])
            worst = max(worst, abs(force[0] / (mass * G) - expected.pop(corner)))
        worst = max([worst, *expected.values()])
    return float(worst)


def kissing_cubes():
    R = np.array([[0.94096063217417758029, 0.29296840037289501035, 0.16959541586174811667],
                  [-0.23569836841299879326, 0.92661523595848427348, -0.29296840037289506586],
                  [-0.2429801799032638987, 0.23569836841299884878, 0.94096063217417758029]])
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, R.flatten())
    worst = 0.0
    for dim in (0.01, 0.25, 0.5, 10, 1000):
        for e in (-1e-15, -2.5e-16, -1e-16, 0, 1e-16, 2.5e-16, 1e-15):
            a = np.array([0, 0, 5 * dim])
            b = a + R @ np.array([0, dim + e * max(1, dim), 0])
            geoms = "".join(f'<geom type="box" size="{dim / 2} {dim / 2} {dim / 2}" pos="{p[0]:.17g} {p[1]:.17g} {p[2]:.17g}" '
                            f'quat="{quat[0]:.17g} {quat[1]:.17g} {quat[2]:.17g} {quat[3]:.17g}"/>' for p in (a, b))
            m, d = model(geoms)
            mujoco.mj_forward(m, d)
            worst = max(worst, abs(mujoco.mj_geomDistance(m, d, 0, 1, 10 * dim, np.zeros(6)) - e * max(1, dim)))
    return worst / 1.5e-8


CASES = {
    "pendulum": pendulum,
    "double-pendulum-10s": lambda: double_pendulum(10, (-0.568474664015950189, -0.526393727932404698, 6.07838488576196486,
                                                        -9.68136068170887876)),
    "double-pendulum-20s": lambda: double_pendulum(20, (0.748760975479181827, -25.8324619988937768, 4.07800396927508779,
                                                        2.77988945538666974)),
    "box-complex": lambda: box_complex(10, (0.225164563413958164, -0.619927562499452488, -0.277029150687194592,
                                            0.698745723640310141)),
    "box-1000s": lambda: box_complex(1000, (-0.885636055626914724, -0.0400448466590370319, -0.449882040184558476,
                                            -0.107941359770173042)),
    "box-invariants": box_invariants,
    "heavy-top-0.1s": lambda: heavy_top(0.1, (0.421296658925402044, 0.894571974345592991, -0.149164700561899612)),
    "heavy-top-2s": lambda: heavy_top(2, (-0.150416822745641760, -0.724165591636895651, -0.673022269560444096)),
    "bricard-6-rows": bricard,
    "four-bar-spring": four_bar_spring,
    "stack-penetration": stack_penetration,
    "table-least": table_least,
    "incline-sticks": incline_sticks,
    "incline-slides": incline_slides,
    "block-stops": block_stops,
    "sphere-rolls": sphere_rolls,
    "isotropy": isotropy,
    "kissing-cubes": kissing_cubes,
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="cases; default all of the command's")
    parser.add_argument("--dyn", default="build/release/bin/dyn", help="the command")
    options = parser.parse_args()
    answer = subprocess.run([options.dyn, "stress", "--json", *options.names], capture_output=True, text=True)
    if not answer.stdout:
        parser.error(answer.stderr.strip())
    print(f"| case | error is | tolerance | libdyn | MuJoCo {mujoco.__version__} |\n|---|---|---|---|---|")
    for case in json.loads(answer.stdout)["cases"]:
        name, error = case["name"], case["error"]
        mine = ("%.1e" % error if error is not None else "refused") + ("" if case["passed"] else " (fails)")
        theirs = "%.1e" % CASES[name]() if name in CASES else ""
        print(f"| {name} | {case['metric'].replace('|', chr(92) + '|')} | {case['tolerance']:.0e} | {mine} | {theirs} |",
              flush=True)


if __name__ == "__main__":
    main()
