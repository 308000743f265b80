"""Drake: continuous plants by every integrator, in steps and for an accuracy; where something touches or loops close, discrete plants, too."""

import re

import numpy as np
import pydrake
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import ConstantVectorSource, FirstOrderLowPassFilter

from common import Failed, ladder, measured, steps_of

try:
    from importlib.metadata import version
    VERSION = version("drake")
except ImportError:
    VERSION = "?"
NAME = "Drake"
FIXED = ("explicit_euler", "semi_explicit_euler", "implicit_euler", "velocity_implicit_euler", "runge_kutta2", "runge_kutta3",
         "bogacki_shampine3", "runge_kutta5", "radau1", "radau3")
CONTROLLED = ("bogacki_shampine3", "runge_kutta3", "runge_kutta5", "radau1", "radau3", "implicit_euler", "velocity_implicit_euler")
TOUCHING = ("runge_kutta3", "radau3", "cenic")


class Scene:
    def __init__(self, problem, dt=0.0, approximation="lagged", stiffness=None, stiction=1e-4):
        self.problem = problem
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(time_step=dt, contact_model="point", discrete_contact_approximation=approximation,
                                      stiction_tolerance=stiction)
        plant, graph = AddMultibodyPlant(config, builder)
        text = problem.mjcf
        for name, mu in problem.frictions.items():
            text = re.sub(rf'(<geom name="{name}"[^>]*friction=")[^ ]*', rf"\g<1>{mu!r}", text)
        text = re.sub(r'<general (name="\w+" joint="\w+")[^>]*/>', r"<motor \1/>", text)
        text = re.sub(r"<equality>.*?</equality>|<site [^>]*/>", "", text)
        Parser(plant).AddModelsFromString(text, "xml")
        plant.mutable_gravity_field().set_gravity_vector([float(x) for x in re.search(r'gravity="([^"]*)"', text)[1].split()])
        if stiffness or problem.restitution:
            self.stiffen(plant, graph, stiffness or 1e6, 0.0 if problem.restitution else 10.0)
        body = lambda name: plant.world_body() if name == "world" else plant.GetBodyByName(name)
        if dt:
            for a, p, b, r in problem.loops:
                plant.AddBallConstraint(body(a), np.array(p, dtype=float), body(b), np.array(r, dtype=float))
        plant.Finalize()
        if problem.ctrl:
            source = builder.AddSystem(ConstantVectorSource(np.array(list(problem.ctrl.values()), dtype=float)))
            low_pass = builder.AddSystem(FirstOrderLowPassFilter(1.0, plant.num_actuators()))
            builder.Connect(source.get_output_port(), low_pass.get_input_port())
            builder.Connect(low_pass.get_output_port(), plant.get_actuation_input_port())
        self.plant, self.diagram = plant, builder.Build()
        self.simulator = Simulator(self.diagram)
        self.first = self.diagram.CreateDefaultContext()
        at = plant.GetMyMutableContextFromRoot(self.first)
        force = np.zeros(plant.num_velocities())
        q, v = plant.GetPositions(at).copy(), np.zeros(plant.num_velocities())
        for name, x in problem.q.items():
            q[plant.GetJointByName(name).position_start()] = x
        for name, x in problem.v.items():
            self.put(plant, name, x, v)
        for name, x in problem.tau.items():
            self.put(plant, name, x, force)
        plant.SetPositions(at, q), plant.SetVelocities(at, v)
        plant.get_applied_generalized_force_input_port().FixValue(at, force)
        self.bodies = [(body(name), np.array(p, dtype=float)) for name, p in problem.markers]

    @staticmethod
    def put(plant, name, x, out):
        """A free joint's velocity is (angular, linear) there; attitudes are those of the world."""
        joint = plant.GetJointByName(name)
        x = np.atleast_1d(x)
        if joint.num_velocities() == 6:
            x = np.concatenate([x[3:], x[:3]])
        out[joint.velocity_start():joint.velocity_start() + len(x)] = x

    @staticmethod
    def stiffen(plant, graph, stiffness, dissipation):
        from pydrake.geometry import AddContactMaterial, ProximityProperties, Role, RoleAssign
        from pydrake.multibody.plant import CoulombFriction

        inspector = graph.model_inspector()
        for shape in inspector.GetAllGeometryIds(Role.kProximity):
            old = inspector.GetProximityProperties(shape)
            new = ProximityProperties(old)
            mu = old.GetPropertyOrDefault("material", "coulomb_friction", CoulombFriction(0, 0))
            for name in ("point_contact_stiffness", "hunt_crossley_dissipation", "coulomb_friction", "relaxation_time"):
                new.RemoveProperty("material", name)
            AddContactMaterial(dissipation=dissipation, point_stiffness=stiffness, friction=mu, properties=new)
            graph.AssignRole(plant.get_source_id(), shape, new, RoleAssign.kReplace)

    def configure(self, scheme, step, accuracy=0.0):
        config = SimulatorConfig(integration_scheme=scheme, max_step_size=step, use_error_control=accuracy > 0)
        if accuracy:
            config.accuracy = accuracy
        ApplySimulatorConfig(config, self.simulator)

    def begin(self):
        context = self.simulator.get_mutable_context()
        context.SetTimeStateAndParametersFrom(self.first)
        at = self.plant.GetMyMutableContextFromRoot(context)
        port = self.plant.get_applied_generalized_force_input_port()
        port.FixValue(at, port.Eval(self.plant.GetMyContextFromRoot(self.first)))
        self.simulator.Initialize()

    def move(self, k):
        self.simulator.AdvanceTo(self.problem.times[k])

    def look(self):
        at = self.plant.GetMyContextFromRoot(self.simulator.get_context())
        out = np.array([self.plant.EvalBodyPoseInWorld(at, body).multiply(p) for body, p in self.bodies])
        if not np.all(np.isfinite(out)):
            raise Failed("not a number")
        return out


def continuous(problem, reference, controlled, fixed, tag="", **material):
    scene = Scene(problem, **material)

    def by_step(method, value):
        scene.configure(method.split(",")[0], value)
        return measured(method, value, scene.begin, scene.move, scene.look, reference, problem)

    def by_accuracy(method, value):
        scene.configure(method.split(",")[0], problem.duration / 10, value)
        return measured(method, value, scene.begin, scene.move, scene.look, reference, problem)

    out = [p for scheme in fixed for p in ladder(scheme + tag, steps_of(problem), by_step)]
    return out + [p for scheme in controlled for p in ladder(scheme + ", accuracy" + tag, [10.0**-e for e in range(1, 14)],
                                                             by_accuracy)]


def discrete(problem, reference, approximation, tag="", **material):
    def measure(method, value):
        try:
            scene = Scene(problem, value, approximation, **material)
        except RuntimeError as e:
            from common import Point
            return Point(method, value, None, 0, None, str(e).splitlines()[0][:200])
        return measured(method, value, scene.begin, scene.move, scene.look, reference, problem)

    return ladder(f"discrete, {approximation}{tag}", steps_of(problem), measure)


def points(problem, reference):
    if problem.kind == "smooth":
        return continuous(problem, reference, CONTROLLED, FIXED)
    out = [p for approximation in ("sap", "similar", "lagged") for p in discrete(problem, reference, approximation)]
    if problem.kind == "loops":
        return out
    out += discrete(problem, reference, "tamsi")  # has no constraints
    out += [p for approximation in ("sap", "lagged") for p in discrete(problem, reference, approximation, ", stiff",
                                                                       stiffness=1e9, stiction=1e-6)]
    out += continuous(problem, reference, TOUCHING, ())
    return out + continuous(problem, reference, ("runge_kutta3", "radau3"), (), ", stiff", stiffness=1e8, stiction=1e-6)
