"""Run where the wheel alone is installed: a quadruped stands and is pushed, its page is written; what else is in the wheel works.

stands.py PAGE [--no-command]     --no-command: where a program cannot start the command dyn, as under qemu-user
"""

import subprocess
import sys
from pathlib import Path

import numpy as np

import libdyn as dyn

SCENE = dyn.models / "scenes/go2_stands.xml"


def stands():
    m = dyn.load(SCENE)
    sim = dyn.Simulation(m, "standing", dt=2e-3)
    d = sim.data
    height = d.q[2]
    sim.run(1.0)
    d.apply_wrench("base", [0, 60, 0, 0, 0, 0])
    sim.run(0.2)
    d.clear_wrenches()
    sim.run(1.8)
    assert abs(d.q[2] - height) < 0.02 and len(d.step_contacts()) >= 4, (d.q, height)
    print(f"{dyn.build_info}: after a push of 60 N the trunk is {d.q[2]:.3f} m up, on {len(d.step_contacts())} contacts")


def meshes(folder):
    """The module of meshes, and libccd, without which the last call is an error."""
    corners = (((0, 0, 0), (0, 1, 0), (1, 0, 0)), ((0, 0, 0), (1, 0, 0), (0, 0, 1)), ((0, 0, 0), (0, 0, 1), (0, 1, 0)),
               ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    vertices = ("".join(f"vertex {x} {y} {z}\n" for x, y, z in face) for face in corners)
    facets = "".join(f"facet normal 0 0 0\nouter loop\n{v}endloop\nendfacet\n" for v in vertices)
    file = folder / "corner.stl"
    file.write_text(f"solid corner\n{facets}endsolid\n", encoding="ascii")
    mesh = dyn.load_mesh(file)
    assert abs(mesh.info.volume - 1 / 6) < 1e-12 and len(mesh.hull().vertices) == 4
    tube, box = ("cylinder", (0.5, 1)), ("box", (1, 1, 1))
    near = dyn.geometry_distance(tube, (np.eye(3), [0, 0, 0]), box, (np.eye(3), [0.9, 0.1, 0.05]), method="ccd")
    assert abs(near.distance + 0.1) < 1e-6, near
    print("a mesh and its hull, libccd: fine")


def pages(page):
    """dyn sim and dyn view write pages by themselves."""
    command = [str(Path(sys.executable).with_name("dyn"))] if sys.platform != "win32" else [sys.executable, "-m", "libdyn"]
    view = page.with_name("view.html")
    for words in (["sim", SCENE, "--configuration", "standing", "--duration", "3", "--html", page],
                  ["view", dyn.models / "robots/panda.urdf", "--fixed", "--html", view]):
        subprocess.run([*command, *map(str, words)], check=True, stdout=subprocess.DEVNULL)
    for file in (page, view):
        text = file.read_text(encoding="utf-8")
        assert len(text) > 300_000 and 'id="dyn-head"' in text, file
    print(f"{page.name}: {page.stat().st_size} bytes")


def sweep():
    pendulum = dyn.models / "robots/double_pendulum.urdf"
    result = dyn.accuracy.sweep(pendulum, base="fixed", q=[1.2, 0.4], duration=0.2, target="1e-3m", budget="5s")
    assert result["recommended"] and len(result["points"]) > 5
    print(f"{len(result['points'])} settings swept")


assert Path(dyn.library_path).parent.parent == Path(dyn.__file__).parent, dyn.library_path
stands()
meshes(Path(sys.argv[1]).parent)
if "--no-command" not in sys.argv:
    pages(Path(sys.argv[1]))
    sweep()
