"""What README and the pages say: links and files that they name exist, and what they show runs."""

import os
import re
import shlex
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import CAPI, MODELS
from command import CLI

import libdyn as dyn

ROOT = CAPI.parent
DOCUMENTS = [
    p for p in (
        ROOT / "README.md", *sorted((CAPI / "pages").glob("*.md")), CAPI / "CHANGELOG.md", ROOT / ".github" / "CONTRIBUTING.md",
        ROOT / "models" / "README.md", ROOT / "tests" / "golden" / "README.md", ROOT / "tools" / "bare_metal" / "README.md",
        CAPI / "examples" / "board" / "README.md",
    )
]  # fmt: skip
if not (ROOT / "README.md").exists():  # an installed package without its checkout
    pytest.skip("no documents here", allow_module_level=True)
document = pytest.mark.parametrize("path", DOCUMENTS, ids=lambda p: str(p.relative_to(ROOT)))


def blocks(path, language=""):
    """Fenced blocks of a language."""
    found, block, kind = [], None, None
    for line in path.read_text(encoding="utf-8").splitlines(keepends=True):
        if not line.startswith("```"):
            if block is not None:
                block += line
        elif block is None:
            block, kind = "", line[3:].strip()
        else:
            if kind == language:
                found.append(block)
            block = None
    return found


def prose(path):
    """The text without its fenced blocks."""
    return re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.S | re.M)


def headings(path):
    """Anchors, as GitHub makes them."""
    found = re.findall(r"^#+ (.*)$", prose(path), re.M)
    return {re.sub(r"[^a-z0-9 _-]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", h).lower()).replace(" ", "-") for h in found}


@document
def test_links(path):
    text = re.sub(r"`[^`\n]*`", "", prose(path))
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        file, _, anchor = target.partition("#")
        there = (path.parent / file).resolve() if file else path
        assert there.exists(), f"{path.name} links {target}, which is not there"
        assert not anchor or anchor in headings(there), f"{path.name} links {target}: that page has no such heading"


# names of examples, of what is made, and of what other packages hold
MADE_UP = re.compile(r"^(build|PWD|/tmp|/usr|/ws|DIR|mujoco|NAME|<)|package:|\.\.\./|\bgo2\.xml|robot\.|arm\.|scene\.|out\.csv|NAME\.")
FILE = re.compile(r"(?<![\w/.<$-])((?:[\w.-]+/)+[\w.-]+\.(?:py|cpp|hpp|h|c|sh|urdf|svg|png|md|def|xml|cmake|ld|lua|rb|pl|rs|go))\b")


@document
def test_files_that_are_named(path):
    for name in FILE.findall(path.read_text(encoding="utf-8")):
        if MADE_UP.search(name) or name.startswith("../"):
            continue
        places = [ROOT, path.parent, ROOT / "include", CAPI, CAPI / "python", ROOT / "src"]
        assert any((place / name).exists() for place in places), f"{path.name} names {name}, which is not there"


def test_no_page_is_alone():
    """Every page is linked from another one, or from the README."""
    linked = {Path(target.partition("#")[0]).name for p in DOCUMENTS for target in re.findall(r"\]\(([^)\s]+)\)", prose(p))
              if p.name != target}
    assert {p.name for p in (CAPI / "pages").glob("*.md")} <= linked


# --------------------------------------------------------------------------------------------------- commands


def commands():
    """Lines of shell blocks that call `dyn`."""
    for path in DOCUMENTS:
        for block in blocks(path):
            for line in block.splitlines():
                line = line.removeprefix("$ ")
                if line.startswith("dyn "):
                    yield pytest.param(line, id=f"{path.stem}: {line.split('  ')[0][:70]}")


# what takes long, or files that are a user's own; such lines are tried with --help alone
LONG = re.compile(r"dyn (stress( |$)(?!.*--list)|bench|view|accuracy)|--html|arm\.urdf|F\b|FILE|\(some of")


@pytest.fixture
def folder(tmp_path):
    """A folder that looks like the project's, to write into."""
    (tmp_path / "models").symlink_to(MODELS)
    return tmp_path


@pytest.mark.skipif(not CLI, reason="the command dyn is not built")
@pytest.mark.parametrize("line", list(commands()))
def test_command(line, folder):
    words = shlex.split(line, comments=True)[1:]
    if any(w.startswith("(") for w in words):
        words = words[: next(k for k, w in enumerate(words) if w.startswith("("))]
    words = [str(folder / "go2.xml") if w == "/tmp/go2.xml" else w for w in words]
    if LONG.search(line):
        words = [words[0], "--help"]
    done = subprocess.run([CLI, *words], cwd=folder, capture_output=True, text=True, timeout=300)
    if "there is no page to fill" in done.stderr:
        pytest.skip("built without npm and Debian's packages: no viewer")
    assert done.returncode == 0, done.stderr
    assert done.stdout or words[0] == "convert"  # which writes a file


def scripts():
    """Commands that run a script of the project: its file, and their options."""
    for path in DOCUMENTS:
        for line in {line for block in blocks(path)
                     for line in block.splitlines()} | set(re.findall(r"`([^`\n]+)`", prose(path))):
            for command in line.split("#")[0].split("&&"):
                words = command.split()
                file = next((w for w in words if re.fullmatch(r"(bench|tools|capi|tests|models)/[\w/.]+", w)), None)
                if file and (ROOT / file).is_dir() and not (ROOT / file / "__main__.py").exists():
                    continue  # a folder that is named
                if file and (words[0] == file or any(w.startswith("python") for w in words[: words.index(file)])):
                    yield path, file, [w.split("=")[0] for w in words[words.index(file) :] if w.startswith("--")]


def test_scripts_have_the_options():
    """What documents tell to run exists, and knows the options that it is given."""
    found = list(scripts())
    assert len(found) > 15
    for path, file, options in found:
        there = ROOT / file
        source = (there / "__main__.py" if there.is_dir() else there).read_text(encoding="utf-8")
        for option in options:
            assert option in source, f"{path.name}: {file} has no {option}"


# --------------------------------------------------------------------------------------------------- Python


TESTED = {"coming_from"}  # pages with a test of their own
# What a block takes for granted, by page and number; $ stands for the folder that it runs in.
GIVEN = {
    "batches 1": "q = np.array([m.random(k) for k in range(4)]); v, a = np.zeros((2, 4, m.nv))",
    "accuracy 2": "m = dyn.load('models/robots/double_pendulum.urdf', base='fixed'); d = m.data(); q = [1.2, 0.4]; v = tau = "
                  "np.zeros(2)",
    "collision 1": """
origins, directions = np.array([[0, 0, 5.0]] * 2), np.array([[0, 0, -1.0]] * 2)
a, b, X_a, X_b, motion_a, motion_b = ("box", (1, 1, 1)), ("sphere", 0.5), (np.eye(3), (0, 0, 0)), (np.eye(3), (3, 0, 0)), np.zeros(6), np.r_[-1, np.zeros(5)]""",
    "contact 3": "G, g = np.eye(12), np.tile([0.1, 0, -1], 4); mu, e, R, b = [0.5] * 4, [0.1] * 4, np.full(12, 1e-6), "
                 "np.zeros(12)",
    "effects 1": "m = dyn.load('models/robots/panda.urdf', base='fixed'); d = m.data(); q = m.neutral(); v = a = tau = "
                 "np.zeros(m.nv)",
    "effects 2": "b = dyn.Builder('leg').add_joint('hip_joint', 'revolute', axis=(0, 1, 0)).add_body('base', 'hip_joint', 1, "
                 "(0, 0, 1))",
    "frames 1": "arm = dyn.load('models/robots/panda.urdf', base='fixed')",
    "meshes 1": "STL('$/ws/src/arm/meshes/link1.stl')",
    "meshes 2": """
STL('$/link.stl')
link = '<link name="{0}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>' + '<collision><geometry><mesh filename="link.stl"/></geometry></collision>' * 2 + '</link>'
open('robot.urdf', 'w').write('<robot name="r">' + link.format('a') + link.format('b') + '<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint></robot>')
X_a, X_b, points, heights = (np.eye(3), (0, 0, 0)), (np.eye(3), (3, 0, 0)), np.random.default_rng(0).random((20, 3)), np.zeros((3, 3))
mesh = dyn.load_mesh('link.stl')""",
    "operations 1": "import os; os.symlink('models/robots/panda.urdf', 'panda.urdf')",
    "stale 1": "q2 = m.random(2)",
    "tendons 2": """
b = dyn.Builder('finger').add_joint('joint2', 'revolute', axis=(0, 1, 0)).add_body('link2', 'joint2', 1, (1, 0, 0))
b.add_frame('site2', 'link2', (0.02, 0, 0)).add_frame('below', None, (0, 0, -0.05))
b.add_tendon('flexor', [('site', 'below'), ('site', 'site2')], type='spatial')""",
    "states 1": """
import mujoco, types
m.save('go2.xml'); mj_model = mujoco.MjModel.from_xml_path('go2.xml'); mj_data = mujoco.MjData(mj_model)
model, joint_state = m, types.SimpleNamespace(name=[j.name for j in m.joints[2:]])""",
}


def stl(file):
    """A tetrahedron."""
    x = np.eye(4)[:, :3]
    Path(file).parent.mkdir(parents=True, exist_ok=True)
    corner = "vertex {} {} {}\n".format
    facets = ["".join(corner(*x[k]) for k in t) for t in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))]
    Path(file).write_text("solid t\n" + "".join(f"facet normal 0 0 0\nouter loop\n{f}endloop\nendfacet\n" for f in facets)
                          + "endsolid t\n")


def programs():
    for path in DOCUMENTS:
        for k, block in enumerate(blocks(path, "python") if path.stem not in TESTED else ()):
            name = f"{path.stem} {k + 1}"
            yield pytest.param(name, block, id=name)


@pytest.mark.parametrize("name, program", list(programs()))
def test_program(name, program, folder, monkeypatch):
    monkeypatch.chdir(folder)
    m = dyn.load("models/robots/go2.urdf", base="floating")
    random = np.random.default_rng(0)
    names = {"dyn": dyn, "np": np, "STL": stl, "m": m, "d": m.data(), "q": m.random(1),
             **{x: random.standard_normal(m.nv) for x in ("v", "a", "tau")}}
    if name.startswith("meshes"):
        program = program.replace("/ws/src", f"{folder}/ws/src").replace(".dae", ".stl")
        try:
            dyn.Mesh.from_arrays(np.eye(3)).hull()
        except dyn.UnsupportedError:
            pytest.skip("no libdyn_mesh.so")
        except dyn.Error:
            pass
    if name.startswith("states"):
        pytest.importorskip("mujoco")
    for package in re.findall(r"^from libdyn.doors import (\w+)", program, re.M):
        pytest.importorskip(package)
    if "gym" in program:
        pytest.importorskip("gymnasium")
    if ".plot(" in program:
        pytest.importorskip("matplotlib")
    exec(GIVEN.get(name, "").replace("$", str(folder)), names)
    if "StaleError" in program:
        with pytest.raises(dyn.StaleError):
            exec(program, names)
    else:
        try:
            exec(compile(program, name, "exec"), names)
        except (dyn.FileError, dyn.UnsupportedError) as error:
            if "DYN_CLI" in str(error) or "there is no page to fill" in str(error):
                pytest.skip("no command dyn here, or none with a page")
            raise


def test_what_is_given_is_shown():
    assert GIVEN.keys() <= {p.id for p in programs()}


def test_the_readme_shows_the_example():
    assert blocks(ROOT / "README.md", "c")[0] == (CAPI / "examples" / "rnea.c").read_text(encoding="utf-8")


# --------------------------------------------------------------------------------------------------- the source's own lists


def test_primitive_joints():
    page = (CAPI / "pages" / "inside.md").read_text(encoding="utf-8")
    listed = re.search(r"define DYN_PRIMITIVES\(X\)(.*?)\n\n", (ROOT / "src/joint/list.hpp").read_text(), re.S)[1]
    assert set(re.findall(r"^ \|- (\w+)", page, re.M)) == set(re.findall(r"X\((\w+)\)", listed))


def test_modules():
    """The page shows the order of the modules that tests/contract/layers.py holds."""
    lines = blocks(CAPI / "pages" / "inside.md")[0].splitlines()
    shown = [re.split(r" {3,}", line)[0].split() for line in lines]
    order = re.search(r'ORDER = """\n(.*?)"""', (ROOT / "tests" / "contract" / "layers.py").read_text(), re.S)[1]
    assert shown == [line.split() for line in order.splitlines()]


def test_exercises_are_there():
    """Tests that the page names are tests."""
    page = (CAPI / "pages" / "exercises.md").read_text(encoding="utf-8")
    there = {name for file in (CAPI / "python" / "tests").glob("test_*.py")
             for name in re.findall(r"^def (test_\w+)", file.read_text(), re.M)}
    there |= {file.stem for file in (CAPI / "python" / "tests").glob("test_*.py")}
    assert set(re.findall(r"\b(test_\w+)\b", page)) <= there
    assert ({p.name for p in (CAPI / "python" / "examples").glob("*.py")}
            <= set(re.findall(r"(\w+\.py)\)", page))), "every example is in the table"
    assert os.listdir(CAPI / "examples")


def test_recipes_name_what_is_there():
    """Files and identifiers of CONTRIBUTING's recipes, wherever in the source they are."""
    text = (ROOT / ".github" / "CONTRIBUTING.md").read_text(encoding="utf-8")
    kinds = (".hpp", ".cpp", ".h", ".def", ".py", ".js")
    source = "\n".join(
        p.read_text(encoding="utf-8", errors="replace") for d in ("include", "src", "capi", "tests", "tools", "bench")
        for p in (ROOT / d).rglob("*") if p.suffix in kinds
    )
    for name in set(re.findall(r"`([A-Za-z_][\w:]*)`", text)):
        assert re.search(rf"\b{name.split('::')[-1]}", source), f"CONTRIBUTING.md speaks of {name}, which is nowhere"
    paths = [f"/{p.relative_to(ROOT)}" for d in (".github", "include", "src", "capi", "tests", "tools", "bench", "models")
             for p in (ROOT / d).rglob("*")]
    for name in set(re.findall(r"`([\w./]+\.(?:hpp|cpp|h|def|py|md|sh))`", text)):
        there = name.split("/")[-1].startswith("NAME.") or any(p.endswith(f"/{name}") for p in paths)
        assert there, f"CONTRIBUTING.md names {name}, which is not there"
