"""Pinocchio's figures for one robot, in libdyn's order and conventions.

Where the conventions differ:
- order: Pinocchio visits the joints of a link in alphabetical order, libdyn in file order. Everything is found by name.
- continuous joints: Pinocchio stores (cos, sin), libdyn the angle. v is the same.
- mimic: Pinocchio keeps followers as joints of their own unless buildModelFromUrdf(.., mimic=True), which ABA, Minv,
  energies, Coriolis, derivatives.. do not support, and which refuses a file whose follower comes alphabetically before
  its leader (talos, romeo). So every figure is computed with the full model and projected by the constant matrix G:
      q_full = expand(q)   v_full = G v   a_full = G a   tau = G' tau_full   M = G' M_full G   C = G' C_full G
      J = J_full G         Minv = M^-1    ddq = M^-1 (tau - nle)
  G has one row for a degree of freedom of Pinocchio, one column for one of libdyn: it does the reordering too.
- fixed base: the mass of the root link sits on Pinocchio's `universe` and counts nowhere (total mass, com, energies).
- centerOfMass leaves subtree centres of mass in the joint's frame: here they are in the world's.
- crba, computeMinverse fill one triangle: here matrices are full.
- getFrameJacobianTimeVariation(LOCAL_WORLD_ALIGNED) is checked here against the time derivative of the Jacobian.
- derivatives of a frame's velocity and spatial acceleration in LOCAL_WORLD_ALIGNED hold the frame's origin still; here it
  moves, as the velocity and acceleration themselves say: w x J is added (dw x J). Those of points' classical ones are as here.
- the tensor of a kinematic Hessian comes as an array in row-major order, though its numbers are in column-major order.
The same: 6D vectors [linear; angular], quaternion (x, y, z, w), floating base [position, quaternion] and [v; w] in the
body's frame, external forces in the joint's frame at its origin, classical and spatial accelerations, the references.
"""
import numpy as np
import pinocchio as pin

REFERENCES = {"LOCAL": pin.LOCAL, "WORLD": pin.WORLD, "LOCAL_WORLD_ALIGNED": pin.LOCAL_WORLD_ALIGNED}


def symmetric(upper):
    return np.triu(upper) + np.triu(upper, 1).T


class Peer:
    def __init__(self, path, robot, mimic=False):
        """robot: the order (reference.Robot). mimic: Pinocchio's own reduction, for cross-checks of what it supports."""
        floating = robot.joints[0].kind == "floating"
        base = [pin.JointModelFreeFlyer()] if floating else []
        self.model = pin.buildModelFromUrdf(str(path), *base, mimic=mimic)
        self.data = self.model.createData()
        self.robot = robot
        names = set(self.model.names) - {"universe"}
        if names != {j.name for j in robot.joints}:
            raise ValueError(f"Pinocchio has other joints than the file: {names ^ {j.name for j in robot.joints}}")

        # rows: Pinocchio's velocities, columns: libdyn's
        self.G = np.zeros((self.model.nv, robot.nv))
        self.leaders = np.zeros((robot.nv, self.model.nv))
        for joint in robot.joints:
            if mimic and joint.leader:
                continue
            row, width = self.model.joints[self.id(joint)].idx_v, max(joint.nv, 1)
            self.G[row:row + width, joint.idx_v:joint.idx_v + width] = joint.multiplier * np.eye(width)
            if not joint.leader:
                self.leaders[joint.idx_v:joint.idx_v + width, row:row + width] = np.eye(width)
        assert np.array_equal(self.leaders @ self.G, np.eye(robot.nv)), "the permutation does not come back"

    def id(self, joint):
        return self.model.getJointId(joint.name)

    def frame(self, frame):
        """By name alone: names that a link and a joint share are not chosen."""
        return self.model.getFrameId(frame["name"])

    def to_pin(self, q):
        """libdyn's q to Pinocchio's."""
        out = pin.neutral(self.model)
        for joint in self.robot.joints:
            there = self.model.joints[self.id(joint)]
            if joint.kind == "floating":
                out[there.idx_q:there.idx_q + 7] = q[joint.idx_q:joint.idx_q + 7]
            elif not (joint.leader and there.shortname() == "JointModelMimic"):
                x = joint.multiplier * q[joint.idx_q] + joint.offset
                out[there.idx_q:there.idx_q + there.nq] = [np.cos(x), np.sin(x)] if there.nq == 2 else [x]
        return out

    def from_pin(self, q):
        """Pinocchio's q to libdyn's; the angle of a continuous joint comes back in (-pi, pi]."""
        out = np.zeros(self.robot.nq)
        for joint in self.robot.joints:
            there = self.model.joints[self.id(joint)]
            if not joint.leader:
                x = q[there.idx_q:there.idx_q + there.nq]
                out[joint.idx_q:joint.idx_q + joint.nq] = np.arctan2(x[1], x[0]) if there.nq == 2 else x
        return out

    def forces(self, fext):
        return [pin.Force(np.array(fext[name])) if name in fext else pin.Force.Zero() for name in self.model.names]

    def frame_motion(self, frame, reference):
        """Velocity, spatial and classical acceleration after forward kinematics."""
        args = self.model, self.data, self.frame(frame), reference
        return (pin.getFrameVelocity(*args).vector, pin.getFrameAcceleration(*args).vector,
                pin.getFrameClassicalAcceleration(*args).vector)

    def jacobian(self, q, frame, reference):
        return pin.computeFrameJacobian(self.model, self.data, self.to_pin(q), self.frame(frame), reference) @ self.G

    def dynamics(self, q, v, a, tau, fext):
        m, d, G = self.model, self.data, self.G
        Q, V, A, F = self.to_pin(q), G @ v, G @ a, self.forces(fext)
        out = {"M": G.T @ symmetric(pin.crba(m, d, Q)) @ G,
               "nle": G.T @ pin.nonLinearEffects(m, d, Q, V),
               "g": G.T @ pin.computeGeneralizedGravity(m, d, Q),
               "tau": G.T @ pin.rnea(m, d, Q, V, A),
               "tau_fext": G.T @ pin.rnea(m, d, Q, V, A, F),
               "static_torque": G.T @ pin.computeStaticTorque(m, d, Q, F),
               "coriolis": G.T @ pin.computeCoriolisMatrix(m, d, Q, V) @ G}
        if m.nv == self.robot.nv:  # no mimic: Pinocchio's own forward dynamics
            P = G.T
            out["ddq"] = P @ pin.aba(m, d, Q, V, P.T @ tau)
            out["ddq_fext"] = P @ pin.aba(m, d, Q, V, P.T @ tau, F)
            out["Minv"] = P @ symmetric(pin.computeMinverse(m, d, Q)) @ P.T
        else:
            bias_fext = out["tau_fext"] - out["M"] @ a
            out["ddq"] = np.linalg.solve(out["M"], tau - out["nle"])
            out["ddq_fext"] = np.linalg.solve(out["M"], tau - bias_fext)
            out["Minv"] = np.linalg.inv(out["M"])
            out["Minv"] = (out["Minv"] + out["Minv"].T) / 2
        return out

    def derivatives(self, q, v, a, tau):
        """By tangent vectors: columns are right (body) perturbations of q."""
        m, d, G = self.model, self.data, self.G
        Q, V = self.to_pin(q), G @ v
        M = G.T @ symmetric(pin.crba(m, d, Q)) @ G
        ddq = np.linalg.solve(M, tau - G.T @ pin.nonLinearEffects(m, d, Q, V))
        out = {}
        for name, acceleration in ("ddq", ddq), ("dtau", a):
            pin.computeRNEADerivatives(m, d, Q, V, G @ acceleration)
            for by, X in ("_dq", d.dtau_dq), ("_dv", d.dtau_dv):
                X = G.T @ X @ G
                out[name + by] = X if name == "dtau" else -np.linalg.solve(M, X)
        return out

    def centroidal_derivatives(self, q, v, a):
        m, d, G = self.model, self.data, self.G
        X = pin.computeCentroidalDynamicsDerivatives(m, d, self.to_pin(q), G @ v, G @ a)
        return {name: x @ G for name, x in zip(("dh_dq", "dhdot_dq", "dhdot_dv"), X)}

    def rest_derivatives(self, q, v, a, fext):
        """Derivatives by q of the forces at rest and of the velocity of the centre of mass, times a."""
        m, d, G = self.model, self.data, self.G
        Q, V, A = self.to_pin(q), G @ v, G @ a
        out = {"dg_dq a": G.T @ pin.computeGeneralizedGravityDerivatives(m, d, Q) @ A,
               "dstatic_torque_dq a": G.T @ pin.computeStaticTorqueDerivatives(m, d, Q, self.forces(fext)) @ A}
        pin.computeForwardKinematicsDerivatives(m, d, Q, V, A)
        pin.centerOfMass(m, d, Q, V)
        return out | {"dvcom_dq a": pin.getCenterOfMassVelocityDerivatives(m, d) @ A}

    def frame_derivatives(self, q, v, a, frames):
        """Derivatives of velocity, spatial and classical acceleration times a, which is as good as random, and the kinematic
        Hessian times a and v: the matrices would be large files."""
        m, d, G = self.model, self.data, self.G
        Q, V, A = self.to_pin(q), G @ v, G @ a
        pin.computeForwardKinematicsDerivatives(m, d, Q, V, A)
        pin.updateFramePlacements(m, d)
        pin.computeJointKinematicHessians(m, d)
        out = {}
        for frame in frames:
            id = self.frame(frame)
            joint, placement = m.frames[id].parentJoint, m.frames[id].placement
            out[frame["name"]] = {}
            for name, reference in REFERENCES.items():
                dv_dq, da_dq, da_dv, J = (X @ A for X in pin.getFrameAccelerationDerivatives(m, d, id, reference))
                if name == "LOCAL_WORLD_ALIGNED":
                    dv_dq[:3] += np.cross(pin.getFrameVelocity(m, d, id, reference).angular, J[:3])
                    da_dq[:3] += np.cross(pin.getFrameAcceleration(m, d, id, reference).angular, J[:3])
                entry = {"dv_dq a": dv_dq, "da_dq a": da_dq, "da_dv a": da_dv}
                if name != "WORLD":
                    _, by_q, by_v, _ = pin.getPointClassicAccelerationDerivatives(m, d, joint, placement, reference)
                    entry |= {"classical_dq a": by_q @ A, "classical_dv a": by_v @ A}
                H = pin.getFrameKinematicHessian(m, d, id, reference)
                entry["H a v"] = np.einsum("rjk,j,k->r", H.ravel().reshape(H.shape, order="F"), A, V)
                out[frame["name"]][name] = entry
        return out

    def moved(self, q, v, a, frames):
        """{frame: {reference: (velocity, spatial and classical acceleration, J)}}"""
        m, d, G = self.model, self.data, self.G
        Q = self.to_pin(q)
        pin.computeJointJacobians(m, d, Q)
        pin.forwardKinematics(m, d, Q, G @ v, G @ a)
        pin.updateFramePlacements(m, d)
        return {frame["name"]: {name: (*self.frame_motion(frame, reference),
                                       pin.getFrameJacobian(m, d, self.frame(frame), reference) @ G)
                                for name, reference in REFERENCES.items()} for frame in frames}

    def inertial_parameters(self):
        """Ten a joint's body, in the order of libdyn's joints."""
        return np.concatenate([self.model.inertias[self.id(j)].toDynamicParameters() for j in self.robot.joints])

    def regressors(self, q, v, a):
        """(Y, nv x 10 joints; that of the kinetic energy; that of the potential energy)"""
        m, d, G = self.model, self.data, self.G
        Q, V, A = self.to_pin(q), G @ v, G @ a
        columns = np.concatenate([10 * (self.id(j) - 1) + np.arange(10) for j in self.robot.joints])
        return (G.T @ pin.computeJointTorqueRegressor(m, d, Q, V, A)[:, columns],
                pin.computeKineticEnergyRegressor(m, d, Q, V)[columns], pin.computePotentialEnergyRegressor(m, d, Q)[columns])

    def mass_and_energy(self, q, v, a, subtrees):
        m, d, G = self.model, self.data, self.G
        Q, V, A = self.to_pin(q), G @ v, G @ a
        pin.centerOfMass(m, d, Q, V, A)
        out = {"com": d.com[0].copy(), "vcom": d.vcom[0].copy(), "acom": d.acom[0].copy()}
        out["subtree_com"] = {j.name: d.oMi[self.id(j)].act(d.com[self.id(j)]) for j in subtrees}
        out["Jcom"] = pin.jacobianCenterOfMass(m, d, Q) @ G
        pin.computeKineticEnergy(m, d, Q, V)
        pin.computePotentialEnergy(m, d, Q)
        mechanical = pin.computeMechanicalEnergy(m, d, Q, V)
        out["energy"] = {"kinetic": d.kinetic_energy, "potential": d.potential_energy, "mechanical": mechanical}
        pin.computeCentroidalMomentumTimeVariation(m, d, Q, V, A)
        out["hg"], out["dhg"] = d.hg.vector.copy(), d.dhg.vector.copy()
        pin.dccrba(m, d, Q, V)
        out["Ag"], out["dAg"], out["Ig"] = d.Ag @ G, d.dAg @ G, d.Ig.inertia.copy()
        return out

    def frames(self, q, v, a, frames, jacobians):
        m, d, G = self.model, self.data, self.G
        Q = self.to_pin(q)
        pin.computeJointJacobiansTimeVariation(m, d, Q, G @ v)
        pin.forwardKinematics(m, d, Q, G @ v, G @ a)
        pin.updateFramePlacements(m, d)
        placements, motions = {}, {}
        for frame in frames:
            X_WF = d.oMf[self.frame(frame)]
            placements[frame["name"]] = {"translation": X_WF.translation.copy(), "rotation": X_WF.rotation.copy()}
            motions[frame["name"]] = {}
            for name, reference in REFERENCES.items():
                velocity, spatial, classical = self.frame_motion(frame, reference)
                entry = {"velocity": velocity, "acceleration": spatial, "classical_acceleration": classical}
                if jacobians:
                    args = m, d, self.frame(frame), reference
                    entry["J"] = pin.getFrameJacobian(*args) @ G
                    entry["dJ"] = pin.getFrameJacobianTimeVariation(*args) @ G
                motions[frame["name"]][name] = entry
        return {"placements": placements, "frames": motions}

    def integrate(self, q, v):
        """As libdyn: the angle of a continuous joint is q + v, not wrapped."""
        out = self.from_pin(pin.integrate(self.model, self.to_pin(q), self.G @ v))
        for joint in self.robot.joints:
            if joint.kind == "continuous":
                turn = q[joint.idx_q] + v[joint.idx_v]
                assert abs(np.angle(np.exp(1j * (out[joint.idx_q] - turn)))) < 1e-14
                out[joint.idx_q] = turn
        return out

    def difference(self, q0, q1):
        return self.leaders @ pin.difference(self.model, self.to_pin(q0), self.to_pin(q1))

    def configuration(self, q0, q1, v, u):
        S, m = self.leaders, self.model
        Q0, Q1, V = self.to_pin(q0), self.to_pin(q1), self.G @ v
        difference = self.difference(q0, q1)
        neutral = self.from_pin(pin.neutral(m))
        dI = [S @ J @ S.T for J in pin.dIntegrate(m, Q0, V)]
        dD = [S @ J @ S.T for J in pin.dDifference(m, Q0, Q1)]
        return {"q0": q0, "q1": q1, "v": v, "u": u, "neutral": neutral, "integrate": self.integrate(q0, v),
                "difference": difference, "distance": np.linalg.norm(difference),
                "interpolate": self.integrate(q0, u * difference),
                "dIntegrate_arg0": dI[0], "dIntegrate_arg1": dI[1], "dDifference_arg0": dD[0], "dDifference_arg1": dD[1]}
