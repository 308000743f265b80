"""The problems: one MJCF file for all engines, the state it starts from, and where it should be at ten times.

Sources: IFToMM benchmark library (A01, A02), Peters and Hsu 2014 (box), Bruels and Cardona 2010 (top), Erez, Tassa, Todorov 2015
(chain, astronaut), Kang and Hwangbo's SimBenchmark (rolling, bouncing, quadruped), Le Lidec et al. 2024 (slide, drag, mass
ratio).
"""

import math
import re
import subprocess
from dataclasses import dataclass, field
from typing import Callable

import numpy as np

G = 9.81
MOMENTS = 10


@dataclass
class Problem:
    name: str
    title: str
    mjcf: str
    duration: float
    markers: list  # (body, point of it): errors are distances of these
    kind: str = "smooth"  # or "loops", "contact"
    q: dict = field(default_factory=dict)  # joint: coordinate, or place of a free joint (its attitude is that of the file)
    v: dict = field(default_factory=dict)  # joint: rate, or (linear, angular)
    tau: dict = field(default_factory=dict)  # joint: constant force along its axes
    ctrl: dict = field(default_factory=dict)  # actuator: control, through a filter of 1 s
    exact: Callable | None = None  # time -> (markers, 3)
    axes: tuple = (0, 1, 2)  # of the world, along which errors count
    restitution: float = 0
    frictions: dict = field(default_factory=dict)  # geom: coefficient, for an engine that combines two by their harmonic mean
    loops: list = field(default_factory=list)  # (body, point, body, point) that are one

    @property
    def times(self):
        return [self.duration * (k + 1) / MOMENTS for k in range(MOMENTS)]


def scene(bodies, gravity=(0, 0, -G), rest="", loops=()):
    g = " ".join(map(repr, gravity))
    text = f'<mujoco model="scene"><compiler angle="radian"/><option gravity="{g}"/><worldbody>{bodies}</worldbody>{rest}</mujoco>'
    rows = ""
    for k, (a, p, b, r) in enumerate(loops):
        for name, body, x in ((f"loop{k}a", a, p), (f"loop{k}b", b, r)):
            where = "<worldbody>" if body == "world" else re.search(rf'<body name="{body}"[^>]*>', text)[0]
            text = text.replace(where, where + f'<site name="{name}" pos="{x[0]!r} {x[1]!r} {x[2]!r}"/>', 1)
        rows += f'<connect site1="loop{k}a" site2="loop{k}b"/>'
    return text.replace("</worldbody>", f"</worldbody><equality>{rows}</equality>") if rows else text


def inertial(mass, com, I):
    return f'<inertial mass="{mass!r}" pos="{com[0]!r} {com[1]!r} {com[2]!r}" diaginertia="{I[0]!r} {I[1]!r} {I[2]!r}"/>'


def hanging(n):
    """Point masses (their inertia is what MuJoCo needs at least) on rods of 1 m, about y."""
    text = ""
    for k in reversed(range(n)):
        text = (f'<body name="bob{k}" pos="0 0 {-1 if k else 0}"><joint name="hinge{k}" axis="0 -1 0"/>{inertial(1, (0, 0, -1), (1e-14,) * 3)}{text}</body>')
    return scene(text)


def pendulum():
    import mpmath as mp

    def exact(t):
        k = mp.sqrt(0.5)
        s = k * mp.ellipfun("sn", mp.ellipk(k**2) - mp.mpf(t) * mp.sqrt(mp.mpf("9.81")), k=k)  # sin(theta / 2)
        angle = 2 * mp.asin(s)
        return np.array([[float(mp.sin(angle)), 0, -float(mp.cos(angle))]])

    return Problem("pendulum", "pendulum, 10 s (A01)", hanging(1), 10, [("bob0", (0, 0, -1))], q={"hinge0": math.pi / 2},
                   exact=exact)


def double_pendulum():
    return Problem("double-pendulum", "double pendulum, 10 s", hanging(2), 10, [("bob0", (0, 0, -1)), ("bob1", (0, 0, -1))],
                   q={"hinge0": math.pi / 2})


def box():
    I = (10 * (0.16 + 0.81) / 12, 10 * (0.01 + 0.81) / 12, 10 * (0.01 + 0.16) / 12)
    text = scene(f'<body name="box"><freejoint name="box"/>{inertial(10, (0, 0, 0), I)}</body>', (0, 0, -9.8))
    corners = [("box", (x, y, z)) for x in (-0.05, 0.05) for y in (-0.2, 0.2) for z in (-0.45, 0.45)]
    return Problem("box", "tumbling box, 10 s", text, 10, corners, v={"box": (-2, 2, 8, 0.1, 5, 0.1)})


def heavy_top():
    """About x, so that no engine's angles are singular."""
    text = scene(f'<body name="top"><joint name="pin" type="ball"/>{inertial(15, (1, 0, 0), (0.46875, 0.234375, 0.234375))}</body>')
    return Problem("heavy-top", "heavy top, 150 rad/s, 1 s", text, 1, [("top", (1, 0, 0))], v={"pin": (150, 0, -4.61538)})


def planar_chain():
    text = ""
    for k in reversed(range(5)):
        text = (f'<body name="link{k}" pos="{0 if k == 0 else 0.5} 0 0"><joint name="hinge{k}" axis="0 0 1"/>'
                f'{inertial(1, (0.25, 0, 0), (1e-3, 1 / 48, 1 / 48))}{text}</body>')
    return Problem("chain", "planar chain of 5, no gravity, 5 s", scene(text, (0, 0, 0)), 5,
                   [(f"link{k}", (0.5, 0, 0)) for k in range(5)], q={f"hinge{k}": 0.3 * (-1) ** k for k in range(5)},
                   v={f"hinge{k}": x for k, x in enumerate((1.5, -2, 1, 2.5, -3))})


def robot(dyn_command, urdf, folder):
    """A robot of models/ as MJCF, without what is not smooth: limits, dry friction, contact; and without damping, whose laws are
    each engine's own."""
    out = folder / (urdf.stem + ".xml")
    subprocess.run([str(dyn_command), "convert", str(urdf), str(out), "--floating"], check=True, capture_output=True)
    text = out.read_text()
    text = re.sub(r"<(geom|site)\b[^>]*?/>", "", text)
    text = re.sub(r"<body [^>]*?/>", "", text)  # frames alone: no mass
    for attribute in ("range", "limited", "frictionloss", "damping", "actuatorfrcrange", "actuatorfrclimited"):
        text = re.sub(rf'\s{attribute}="[^"]*"', "", text)
    for section in ("contact", "equality", "actuator", "keyframe", "asset"):
        text = re.sub(rf"<{section}>.*?</{section}>", "", text, flags=re.S)
    return text


def flying(dyn_command, urdf, folder, name, title, spin, rates):
    text = robot(dyn_command, urdf, folder)
    joints = re.findall(r'<joint name="([^"]+)" type="hinge"', text)
    free = re.search(r'<joint name="([^"]+)" type="free"', text)[1]
    bodies = re.findall(r'<body name="([^"]+)"', text)
    text = text.replace(f'name="{free}" type="free"', f'name="{bodies[0]}" type="free"')
    v = {joint: rates[k % len(rates)] for k, joint in enumerate(joints)}
    return Problem(name, title, text, 1, [(body, (0, 0, 0)) for body in bodies], v={bodies[0]: spin, **v})


# ---------------------------------------------------------------------------------------------------- closed loops
def four_bars(n=40):
    """n windows: n + 1 uprights, couplers on top, all rods of 1 m and 1 kg; one angle moves them all."""
    import mpmath as mp

    I = (1 / 12,) * 3  # about z, where it turns
    text, loops = "", []
    for k in range(n + 1):
        coupler = f'<body name="coupler{k}" pos="0 1 0"><joint name="top{k}" axis="0 0 1"/>{inertial(1, (0.5, 0, 0), I)}</body>' if k < n else ""
        text += f'<body name="upright{k}" pos="{k} 0 0"><joint name="foot{k}" axis="0 0 1"/>{inertial(1, (0, 0.5, 0), I)}{coupler}</body>'
        if k:
            loops.append((f"coupler{k - 1}", (1, 0, 0), f"upright{k}", (0, 1, 0)))
    v = {f"foot{k}": -1.0 for k in range(n + 1)} | {f"top{k}": 1.0 for k in range(n)}
    # A th'' = B sin th, th from the upright
    A, B = mp.mpf(n + 1) / 3 + n, (mp.mpf(n + 1) / 2 + n) * mp.mpf("9.81")
    E = A / 2 + B
    m, rate = 2 * B / (E + B), mp.sqrt((E + B) / (2 * A))

    def exact(t):
        K = mp.ellipk(m)
        s, c = (mp.ellipfun(f, rate * mp.mpf(t) - K, m=m) for f in ("sn", "cn"))
        half = mp.atan2(s, c) + mp.pi / 2  # sin, cos of the angle alone are needed
        x, y = float(mp.sin(2 * half)), float(mp.cos(2 * half))
        return np.array([[k + x, y, 0] for k in range(n + 1)])

    return Problem("four-bars", f"{n} four-bars, 2 s (A02)", scene(text, (0, -G, 0), loops=loops), 2,
                   [(f"upright{k}", (0, 1, 0)) for k in range(n + 1)], "loops", v=v, exact=exact, loops=loops)


def squeezer():
    """Andrews' squeezer (IVP test set, 3)."""
    xa, ya, xb, yb, xc, yc = -0.06934, -0.00227, -0.03635, 0.03273, 0.014, 0.072
    d, da, e, ea, rr, ra, ss, sa, sb, sc, sd = 0.028, 0.0115, 0.02, 0.01421, 0.007, 0.00092, 0.035, 0.01874, 0.01043, 0.018, 0.02
    ta, tb, u, ua, ub, zf, zt, fa = 0.02308, 0.00916, 0.04, 0.01228, 0.00449, 0.02, 0.04, 0.01421
    start = dict(beta=-0.0617138900142764496, theta=0.0, phi=0.222668390165885884674, delta=0.487364979543842550226,
                 omega=-0.222668390165885884674, epsilon=1.23054744454982119249735)
    gamma = 0.455279819163070380256
    x, y = xb + sc * math.sin(gamma) + sd * math.cos(gamma) - xc, yb - sc * math.cos(gamma) + sd * math.sin(gamma) - yc
    start |= dict(spring_angle=math.atan2(y, x), spring=math.hypot(x, y), spring_end=gamma - math.atan2(y, x))

    def body(name, joint, pos, mass, I, com, inner="", kind="hinge", axis="0 0 1", more=""):
        return (f'<body name="{name}" pos="{pos[0]!r} {pos[1]!r} 0"><joint name="{joint}" type="{kind}" axis="{axis}"{more}/>'
                f"{inertial(mass, (com[0], com[1], 0), (I, I, I))}{inner}</body>")

    tiny = 1e-14  # of the telescope's two parts
    k3 = body("K3", "spring_end", (0, 0), 0.02373, 5.255e-6, (sb - sd, sc - sa))
    telescope = body("tube", "spring", (0, 0), tiny, tiny, (0, 0), k3, "slide", "1 0 0", ' stiffness="4530" springref="0.07785"')
    text = (body("K1", "beta", (0, 0), 0.04325, 2.194e-6, (ra, 0), body("K2", "theta", (rr, 0), 0.00365, 4.410e-7, (-da, 0)))
            + body("rod", "spring_angle", (xc, yc), tiny, tiny, (0, 0), telescope)
            + body("K5", "delta", (xa, ya), 0.07050, 1.169e-5, (ta, tb), body("K4", "phi", (zt, 0), 0.00706, 5.667e-7,
                                                                              (0, ea - e)))
            + body("K7", "epsilon", (xa, ya), 0.05498, 1.912e-5, (-ub, -ua),
                   body("K6", "omega", (0, -u), 0.00706, 5.667e-7, (zf - fa, 0))))
    loops = [("K3", (-sd, sc, 0), "world", (xb, yb, 0)), ("K3", (-sd, sc - ss, 0), "K2", (-d, 0, 0)),
             ("K4", (0, -e, 0), "K2", (-d, 0, 0)), ("K6", (zf, 0, 0), "K2", (-d, 0, 0))]
    markers = [("K1", (rr, 0, 0)), ("K2", (-d, 0, 0)), ("K3", (-sd, sc, 0)), ("K5", (zt, 0, 0)), ("K7", (0, -u, 0))]
    return Problem("squeezer", "Andrews' squeezer, 0.03 s (A03)", scene(text, (0, 0, 0), loops=loops), 0.03, markers, "loops",
                   q=start, tau={"beta": 0.033}, loops=loops)


# ---------------------------------------------------------------------------------------------------- contact
FLOOR = '<geom name="floor" type="plane" size="100 100 1" friction="{} 0 0" condim="3"/>'


def on_feet(name, place, mass, half, friction, joint=None):
    """A box on four small balls, whose contact with a plane or a face is a point each, the same for every engine."""
    x, y, z = half
    r = z / 25
    I = tuple(mass / 3 * (half[b] ** 2 + half[c] ** 2) for b, c in ((1, 2), (0, 2), (0, 1)))
    geom = f'<geom name="{name}{{}}" type="{{}}" size="{{}}" pos="{{}}" friction="{friction} 0 0"/>'
    feet = "".join(geom.format(f"_foot{k}", "sphere", f"{r!r}", f"{sx * (x - r)!r} {sy * (y - r)!r} {r - z!r}")
                   for k, (sx, sy) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))))
    top = geom.format("", "box", f"{x!r} {y!r} {z - r / 2!r}", f"0 0 {r / 2!r}")
    return f'<body name="{name}" pos="{place[0]!r} {place[1]!r} {place[2]!r}">{joint or f"<freejoint name={chr(34)}{name}{chr(34)}/>"}{inertial(mass, (0, 0, 0), I)}{top}{feet}</body>'


def slide(mu=0.4):
    stop = 1 / (mu * G)

    def exact(t):
        t = min(t, stop)
        return np.array([[t - mu * G * t * t / 2, 0, 0.1]])

    return Problem("slide", "cube slides to rest, 1.098 s",
                   scene(FLOOR.format(mu) + on_feet("cube", (0, 0, 0.1), 1.0, (0.1, 0.1, 0.1), mu)), 1.098, [("cube", (0, 0, 0))],
                   "contact", v={"cube": (1, 0, 0, 0, 0, 0)}, exact=exact)


def drag(mu=0.4):
    """A force that grows as 30 N (1 - exp(-t / 1 s)) on a block that does not turn: it sticks, then slips."""
    F, weight = 30, mu * G
    slip = -math.log(1 - weight / F)

    def exact(t):
        s = max(t - slip, 0.0)  # x'' = F - weight - (F - weight) exp(-s)
        a = F - weight
        return np.array([[a * (s * s / 2 - s + 1 - math.exp(-s)), 0, 0.1]])

    slides = "".join(f'<joint name="{name}" type="slide" axis="{axis}"/>'
                     for name, axis in (("x", "1 0 0"), ("y", "0 1 0"), ("z", "0 0 1")))
    text = on_feet("cube", (0, 0, 0.1), 1.0, (0.1, 0.1, 0.1), mu, slides)
    actuator = '<actuator><general name="pull" joint="x" dyntype="filter" dynprm="1" gainprm="1"/></actuator>'
    return Problem("drag", "a growing force drags a block, 1 s", scene(FLOOR.format(mu) + text, rest=actuator), 1,
                   [("cube", (0, 0, 0))], "contact", ctrl={"pull": F}, exact=exact)


def stack(ratio=1e3):
    """1 kg under ratio kg, both cubes of 0.2 m: nothing moves."""
    text = FLOOR.format(0.9)
    for k, mass in enumerate((1.0, ratio)):
        text += on_feet(f"cube{k}", (0, 0, 0.1 + 0.2 * k), mass, (0.1, 0.1, 0.1), 0.9)
    return Problem("stack", f"1 kg under {ratio:g} kg, 1 s", scene(text), 1, [("cube0", (0, 0, 0)), ("cube1", (0, 0, 0))],
                   "contact", exact=lambda t: np.array([[0, 0, 0.1], [0, 0, 0.3]]))


def rolling():
    """A box of 20 x 20 x 1 m pushed under 25 balls."""
    angle = math.radians(60)
    push = (150 * math.cos(angle), 150 * math.sin(angle))
    text = FLOOR.format(0.4) + on_feet("box", (0, 0, 0.5), 10.0, (10, 10, 0.5), 0.4)
    markers, rest, frictions = [("box", (0, 0, 0))], [(0, 0, 0.5)], {"floor": 0.8 / 3, "box": 0.8,
                                                                     **{f"box_foot{k}": 0.8 for k in range(4)}}
    for i in range(5):
        for j in range(5):
            name, x, y = f"ball{i}{j}", 2 * i - 4, 2 * j - 4
            text += (f'<body name="{name}" pos="{x} {y} 1.5"><freejoint name="{name}"/>{inertial(1, (0, 0, 0), (0.1,) * 3)}'
                     f'<geom name="{name}" type="sphere" size="0.5" friction="0.8 0 0"/></body>')
            markers.append((name, (0, 0, 0))), rest.append((x, y, 1.5))
            frictions[name] = 0.8
    friction = 0.4 * 35 * G
    ball = (150 - friction) / 10 / (3.5 + 2.5)  # f / m with f = (F - friction) / M / (3.5 / m + 25 / M)
    table = (150 - friction - 25 * ball) / 10
    rest = np.array(rest, dtype=float)

    def exact(t):
        out = rest.copy()
        for a, size in enumerate((math.cos(angle), math.sin(angle))):
            out[0, a] += size * table * t * t / 2
            out[1:, a] += size * ball * t * t / 2
        return out

    return Problem("rolling", "a box pushed under 25 balls, 1 s", scene(text), 1, markers, "contact",
                   tau={"box": (*push, 0, 0, 0, 0)}, exact=exact, axes=(0, 1), frictions=frictions)


def bouncing():
    """49 balls that lose nothing."""
    names = [f"ball{i}{j}" for i in range(7) for j in range(7)]
    text = FLOOR.format(0)
    for k, name in enumerate(names):
        text += (f'<body name="{name}" pos="{2 * (k // 7)} {2 * (k % 7)} 5"><freejoint name="{name}"/>{inertial(10, (0, 0, 0), (0.04,) * 3)}'
                 f'<geom name="{name}" type="sphere" size="0.1" friction="0 0 0"/></body>')
    fall = math.sqrt(2 * 4.9 / G)

    def exact(t):
        s = (t + fall) % (2 * fall) - fall  # from the top
        return np.array([[2 * (k // 7), 2 * (k % 7), 5 - G * s * s / 2] for k in range(49)])

    return Problem("bouncing", "49 balls bounce for 4 s, e = 1", scene(text), 4, [(name, (0, 0, 0)) for name in names], "contact",
                   exact=exact, axes=(2,), restitution=1)


def every(dyn_command, models, folder):
    return [pendulum(), double_pendulum(), box(), heavy_top(), planar_chain(),
            flying(dyn_command, models / "robots/go2.urdf", folder, "quadruped", "quadruped in flight, 1 s",
                   (0.5, 0.2, 3, 2, -1, 3), (3, -4, 5)),
            flying(dyn_command, models / "robots/humanoid.urdf", folder, "astronaut", "humanoid in flight, 1 s",
                   (0.5, 0.2, 3, 0.5, -1, 0.7), (1, -1.5, 2, 0.5)),
            four_bars(), squeezer(), slide(), drag(), stack(), rolling(), bouncing()]
