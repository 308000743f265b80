"""Run where the wheel alone is installed: a quadruped stands and is pushed, its page is written; what else is in the wheel works.

stands.py PAGE
"""

import subprocess
import sys
from pathlib import Path

import numpy as np

import libdyn as dyn

page = Path(sys.argv[1])
command = str(Path(sys.executable).with_name("dyn"))
assert Path(dyn.library_path).is_relative_to(Path(dyn.__file__).parent), dyn.library_path

scene = dyn.models / "scenes/go2_stands.xml"
m = dyn.load(scene)
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

# dyn sim and dyn view write pages by themselves
view = page.with_name("view.html")
for words in (["sim", scene, "--configuration", "standing", "--duration", "3", "--html", page],
              ["view", dyn.models / "robots/panda.urdf", "--fixed", "--html", view]):
    subprocess.run([command, *map(str, words)], check=True, stdout=subprocess.DEVNULL)
for file in (page, view):
    text = file.read_text(encoding="utf-8")
    assert len(text) > 300_000 and 'id="dyn-head"' in text, file

pendulum = dyn.models / "robots/double_pendulum.urdf"
result = dyn.accuracy.sweep(pendulum, base="fixed", q=[1.2, 0.4], duration=0.2, target="1e-3m", budget="5s")
assert result["recommended"] and len(result["points"]) > 5

# the module of meshes, and libccd
cube = "solid c\n" + "".join(
    f"facet normal 0 0 0\nouter loop\n{''.join(f'vertex {x} {y} {z}{chr(10)}' for x, y, z in corners)}endloop\nendfacet\n"
    for corners in (((0, 0, 0), (0, 1, 0), (1, 0, 0)), ((0, 0, 0), (1, 0, 0), (0, 0, 1)), ((0, 0, 0), (0, 0, 1), (0, 1, 0)),
                    ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
) + "endsolid\n"
page.with_name("corner.stl").write_text(cube, encoding="ascii")
mesh = dyn.load_mesh(page.with_name("corner.stl"))
assert abs(mesh.info.volume - 1 / 6) < 1e-12 and len(mesh.hull().vertices) == 4
tube, box = ("cylinder", (0.5, 1)), ("box", (1, 1, 1))
# an error without libccd
near = dyn.geometry_distance(tube, (np.eye(3), [0, 0, 0]), box, (np.eye(3), [0.9, 0.1, 0.05]), method="ccd")
assert abs(near.distance + 0.1) < 1e-6, near
print(f"{page.name}: {page.stat().st_size} bytes; {len(result['points'])} settings swept; a mesh and its hull, libccd: fine")
