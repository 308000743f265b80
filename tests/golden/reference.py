"""An independent second opinion: a URDF reader and rigid-body dynamics with 40 digits.

It shares nothing with Pinocchio, MuJoCo or libdyn. The dynamics is the textbook one, in the world frame and without
spatial algebra: each link's Newton and Euler equations, projected on its geometric Jacobian (virtual work):

    tau = sum over links  Jc' m (c'' - g) + Jw' (I w' + w x I w)        M = sum over links  Jc' m Jc + Jw' I Jw

`Robot` also says what libdyn's order is (joints depth first, children in the order their joints stand in the file;
mimic joints reduced onto their leader), so that generate.py takes the order from the file and not from a peer.

The numbers of the URDF are read as doubles, as every library does; from there on everything has 40 digits. The
quaternion of a floating base is normalised.
"""
import xml.etree.ElementTree as ET

import mpmath
import numpy as np

mp = mpmath.mp.clone()
mp.dps = 40
MOVING = ("revolute", "continuous", "prismatic")


def vector(text):
    return np.array([mp.mpf(float(word)) for word in text.split()], dtype=object)


def exact(array):
    """Doubles as 40-digit numbers, without rounding."""
    return np.array([mp.mpf(float(x)) for x in np.ravel(array)], dtype=object).reshape(np.shape(array))


def double(array):
    """Rounded to the nearest doubles."""
    return np.array([float(x) for x in np.ravel(array)]).reshape(np.shape(array))


def zeros(*shape):
    out = np.empty(shape, dtype=object)
    out.fill(mp.mpf(0))
    return out


def eye3():
    return exact(np.eye(3))


def skew(w):
    o = mp.mpf(0)
    return np.array([[o, -w[2], w[1]], [w[2], o, -w[0]], [-w[1], w[0], o]], dtype=object)


def cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], dtype=object)


def rodrigues(axis, angle):
    K = skew(axis)
    return eye3() + mp.sin(angle) * K + (1 - mp.cos(angle)) * K.dot(K)


def rpy(text):
    roll, pitch, yaw = vector(text)
    x, y, z = exact(np.eye(3))
    return rodrigues(z, yaw).dot(rodrigues(y, pitch)).dot(rodrigues(x, roll))


def from_quaternion(q):
    x, y, z, w = q / mp.sqrt(q.dot(q))
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]], dtype=object)


def origin(element):
    """Rotation and translation of an <origin>, or the identity."""
    tag = element.find("origin")
    if tag is None:
        return eye3(), zeros(3)
    return rpy(tag.get("rpy", "0 0 0")), vector(tag.get("xyz", "0 0 0"))


class Joint:
    """One <joint>, or the floating base; fixed joints are kept, they are links of their own."""

    def __init__(self, name, kind, parent, child):
        self.name, self.kind, self.parent, self.child = name, kind, parent, child
        self.R, self.p, self.axis = eye3(), zeros(3), None
        self.leader, self.multiplier, self.offset = None, 1.0, 0.0
        self.idx_q = self.idx_v = -1
        self.nq = self.nv = 0
        self.lower, self.upper = -np.inf, np.inf


class Robot:
    def __init__(self, path, floating):
        root = ET.parse(path).getroot()
        links = {link.get("name"): link for link in root.findall("link")}
        children = {}
        for tag in root.findall("joint"):
            children.setdefault(tag.find("parent").get("link"), []).append(tag)
        has_parent = {tag.find("child").get("link") for tag in root.findall("joint")}
        self.root, = [name for name in links if name not in has_parent]
        self.inertia = {name: self.read_inertia(link) for name, link in links.items()}

        # depth first in file order; the floating base first
        self.all_joints = [Joint("root_joint", "floating", None, self.root)] if floating else []
        stack = list(reversed(children.get(self.root, [])))
        while stack:
            tag = stack.pop()
            self.all_joints.append(self.read_joint(tag))
            stack.extend(reversed(children.get(tag.find("child").get("link"), [])))
        self.joints = [j for j in self.all_joints if j.kind != "fixed"]
        self.by_name = {j.name: j for j in self.joints}
        self.link_names = [self.root] + [j.child for j in self.all_joints if j.kind != "floating"]

        # positions in q and v: followers have none
        self.nq = self.nv = 0
        for joint in self.joints:
            if joint.leader is None:
                joint.nq, joint.nv = (7, 6) if joint.kind == "floating" else (1, 1)
                joint.idx_q, joint.idx_v = self.nq, self.nv
                self.nq += joint.nq
                self.nv += joint.nv
        for joint in self.joints:
            if joint.leader is not None:
                leader = self.by_name[joint.leader]
                if leader.leader is not None:
                    raise ValueError(f"{joint.name}: a mimic of a mimic")
                joint.idx_q, joint.idx_v = leader.idx_q, leader.idx_v

    @staticmethod
    def read_inertia(link):
        """Mass, centre of mass and rotational inertia about it, both in the link's frame."""
        tag = link.find("inertial")
        if tag is None:
            return mp.mpf(0), zeros(3), zeros(3, 3)
        R, com = origin(tag)
        g = {key: mp.mpf(float(value)) for key, value in tag.find("inertia").attrib.items()}
        I = np.array([[g["ixx"], g["ixy"], g["ixz"]], [g["ixy"], g["iyy"], g["iyz"]], [g["ixz"], g["iyz"], g["izz"]]],
                     dtype=object)
        return mp.mpf(float(tag.find("mass").get("value"))), com, R.dot(I).dot(R.T)

    @staticmethod
    def read_joint(tag):
        joint = Joint(tag.get("name"), tag.get("type"), tag.find("parent").get("link"), tag.find("child").get("link"))
        joint.R, joint.p = origin(tag)
        if joint.kind == "fixed":
            return joint
        if joint.kind not in MOVING:
            raise ValueError(f"{joint.name}: joint type {joint.kind} is not covered")
        axis = vector(tag.find("axis").get("xyz")) if tag.find("axis") is not None else exact([1, 0, 0])
        joint.axis = axis / mp.sqrt(axis.dot(axis))
        limit = tag.find("limit")
        if limit is not None and joint.kind != "continuous":
            joint.lower, joint.upper = float(limit.get("lower", 0)), float(limit.get("upper", 0))
        mimic = tag.find("mimic")
        if mimic is not None:
            joint.leader = mimic.get("joint")
            joint.multiplier = float(mimic.get("multiplier", 1))
            joint.offset = float(mimic.get("offset", 0))
        return joint

    def position(self, joint, q):
        """A joint's own coordinate: its entry of q, or what its leader dictates."""
        if joint.leader is None:
            return q[joint.idx_q]
        return joint.multiplier * q[joint.idx_q] + joint.offset

    def kinematics(self, q, v, a):
        """For each link: R, p, its Jacobian (linear and angular, at its origin), w, w', p'' (gravity not included)."""
        nv = self.nv
        still = (eye3(), zeros(3), zeros(3, nv), zeros(3, nv), zeros(3), zeros(3), zeros(3))
        state = {self.root: still}
        for joint in self.all_joints:
            if joint.kind == "floating":
                R, i = from_quaternion(q[3:7]), joint.idx_v
                Jv, Jw = zeros(3, nv), zeros(3, nv)
                Jv[:, i:i + 3] = Jw[:, i + 3:i + 6] = R
                w = R.dot(v[3:6])
                # spatial acceleration to the acceleration of the origin: add w x v
                state[joint.child] = (R, q[:3], Jv, Jw, w, R.dot(a[3:6]), R.dot(a[:3] + cross(v[3:6], v[:3])))
                continue
            R0, p0, Jv0, Jw0, w0, dw0, ddp0 = state[joint.parent]
            R, r = R0.dot(joint.R), R0.dot(joint.p)
            w, dw, ddp, slide = w0, dw0, zeros(3), zeros(3)
            if joint.kind != "fixed":
                z, k, i = R.dot(joint.axis), mp.mpf(joint.multiplier), joint.idx_v
                x, dx, ddx = self.position(joint, q), k * v[i], k * a[i]
                if joint.kind == "prismatic":
                    slide = z * x
                    ddp = 2 * cross(w0, z * dx) + z * ddx
                else:
                    R = R.dot(rodrigues(joint.axis, x))
                    w, dw = w0 + z * dx, dw0 + z * ddx + cross(w0, z * dx)
            r = r + slide
            Jv, Jw = Jv0 - skew(r).dot(Jw0), Jw0.copy()
            if joint.kind == "prismatic":
                Jv[:, i] += z * k
            elif joint.kind != "fixed":
                Jw[:, i] += z * k
            ddp = ddp + ddp0 + cross(dw0, r) + cross(w0, cross(w0, r))
            state[joint.child] = (R, p0 + r, Jv, Jw, w, dw, ddp)
        return state

    def dynamics(self, q, v, a, fext=None, gravity=(0, 0, -9.81)):
        """M and tau. fext: {joint: [force; moment] in the joint's frame at its origin}."""
        q, v, a, g = exact(q), exact(v), exact(a), exact(gravity)
        state = self.kinematics(q, v, a)
        M, tau = zeros(self.nv, self.nv), zeros(self.nv)
        for name in self.link_names:
            mass, com, I = self.inertia[name]
            R, _, Jv, Jw, w, dw, ddp = state[name]
            c, I = R.dot(com), R.dot(I).dot(R.T)
            Jc = Jv - skew(c).dot(Jw)
            columns = [i for i in range(self.nv) if any(x != 0 for x in Jv[:, i]) or any(x != 0 for x in Jw[:, i])]
            Jc, Jw = Jc[:, columns], Jw[:, columns]
            M[np.ix_(columns, columns)] += mass * Jc.T.dot(Jc) + Jw.T.dot(I.dot(Jw))
            ddc = ddp + cross(dw, c) + cross(w, cross(w, c))
            tau[columns] += Jc.T.dot(mass * (ddc - g)) + Jw.T.dot(I.dot(dw) + cross(w, I.dot(w)))
        for joint in self.joints if fext else []:
            if joint.name in fext:
                R, _, Jv, Jw, *_ = state[joint.child]
                f = exact(fext[joint.name])
                tau -= Jv.T.dot(R.dot(f[:3])) + Jw.T.dot(R.dot(f[3:]))
        return M, tau


def inverse(M):
    """Inverse of a symmetric positive definite matrix by its factor M = L L'."""
    n = len(M)
    L, W = zeros(n, n), zeros(n, n)
    for i in range(n):
        for j in range(i + 1):
            s = M[i, j] - L[i, :j].dot(L[j, :j])
            L[i, j] = mp.sqrt(s) if i == j else s / L[j, j]
    for j in range(n):  # W = L^-1
        W[j, j] = 1 / L[j, j]
        for i in range(j + 1, n):
            W[i, j] = -L[i, j:i].dot(W[j:i, j]) / L[i, i]
    return W.T.dot(W)
