"""The page of lists, capi/pages/lists.md, from the library's own tables:  bench/lists.py

Joint types, shapes, constraints, effects, integrators, contact solvers, algorithms and fields, as dyn_..._info describe them.
"""

from ctypes import byref

from pages import PROJECT

from libdyn import abi
from libdyn.interface import INTERFACE
from libdyn.native import lib
from libdyn.tables import ALGORITHMS, FIELDS

PAGE = PROJECT / "capi/pages/lists.md"


def words(text):
    return text.decode() if isinstance(text, bytes) else text or ""


def table(*rows):
    """Rows of Markdown; the first has the titles."""
    cells = [[str(cell).replace("|", "\\|").replace("*", "\\*") for cell in row] for row in rows]
    cells.insert(1, ["---"] * len(cells[0]))
    return "".join("| " + " | ".join(row) + " |\n" for row in cells)


def infos(enum, info, function):
    """Each value of an enumeration with its info."""
    for value in next(e for e in INTERFACE["enums"] if e["name"] == enum)["values"]:
        found = info()
        if getattr(lib, function)(value["value"], byref(found)) == 0:
            yield value, found


def name_of(enum, value):
    return next((v["name"] for v in next(e for e in INTERFACE["enums"] if e["name"] == enum)["values"] if v["value"] == value),
                "")


def parts(bits):
    part = next(e for e in INTERFACE["enums"] if e["name"] == "dynParts")
    return ", ".join(v["name"] for v in part["values"] if bin(v["value"]).count("1") == 1 and v["value"] & bits)


def joints():
    rows = [(f"`{words(x.name)}`", x.nq, x.nv, words(x.chain), words(x.sentence))
            for _, x in infos("dynJointType", abi.JointTypeInfo, "dyn_joint_type_info")]
    return table(("name", "nq", "nv", "chain of", "what it is"), *rows)


def shapes():
    rows = []
    for _, x in infos("dynShapeType", abi.ShapeTypeInfo, "dyn_shape_type_info"):
        kind = "convex" if x.convex else "surface" if x.surface else ""
        rows.append((f"`{words(x.name)}`", ", ".join(words(x.size[k]) for k in range(x.sizes)), kind, words(x.sentence)))
    return table(("name", "sizes", "kind", "what it is"), *rows)


def constraints():
    rows = [
        (f"`{words(x.name)}`", x.rows or "", "joints" if x.joints else "frames", "yes" if x.one_sided else "", words(x.sentence))
        for _, x in infos("dynConstraintType", abi.ConstraintTypeInfo, "dyn_constraint_type_info")
    ]
    return table(("name", "rows", "between", "bounded force", "what it does"), *rows)


def effects():
    rows = [
        (f"`{words(x.name)}`", words(x.sentence), name_of("dynModelArray", x.array),
         ("", "all Euler steps", "IMPLICIT_FAST")[x.implicit], parts(x.part))
        for _, x in infos("dynEffects", abi.EffectTypeInfo, "dyn_effect_type_info")
    ]
    return table(("name", "what it is", "array of the model", "implicit in", "part"), *rows)


def integrators():
    rows = [
        (f"`{words(x.name)}`", x.order, x.evaluations or "as many as it takes", "yes" if x.implicit else "",
         "yes" if x.estimates else "", words(x.sentence))
        for _, x in infos("dynIntegrator", abi.IntegratorInfo, "dyn_integrator_info")
    ]
    return table(("name", "order", "evaluations", "implicit", "estimates its error", "what it does"), *rows)


def solvers():
    found = infos("dynContactSolverType", abi.ContactSolverTypeInfo, "dyn_contact_solver_type_info")
    return table(("name", "what it does"), *((f"`{words(x.name)}`", words(x.sentence)) for _, x in found))


def algorithms():
    rows, info = [], abi.AlgorithmInfo()
    for name, x in ALGORITHMS.items():
        lib.dyn_algorithm_info(None, x.id, byref(info))
        after = ", ".join(f"`{call}`" for call in words(info.precondition).split())
        rows.append((f"`dyn_{name}`", ", ".join(words(info.inputs).split()), ", ".join(x.outputs), parts(info.part), after))
    return table(("function", "inputs", "outputs", "part", "after"), *rows)


def quantities():
    rows = [(f"`{f.name}`", f.shape, f.unit, f.frame, parts(int(f.part)), f"`{f.producer}`" if f.producer else "", f.sentence)
            for f in FIELDS.values()]
    return table(("name", "shape", "unit", "frame", "part", "made by", "what it is"), *rows)


def parameters():
    values = next(e for e in INTERFACE["enums"] if e["name"] == "dynParameterGroup")["values"]
    return table(("name", "what is in it"), *((f"`{v['name'].lower()}`", v["doc"]) for v in values))


SECTIONS = {
    "Joint types": joints, "Shapes": shapes, "Constraints": constraints, "Effects": effects, "Integrators": integrators,
    "Contact solvers": solvers, "Algorithms": algorithms, "Fields": quantities,
    "Groups of parameters": parameters,
}  # fmt: skip


def page():
    begin = "# Lists\n\nWhat the library knows by name. `bench/lists.py` writes this page from the library's own tables.\n"
    return begin + "".join(f"\n## {title}\n\n{make()}" for title, make in SECTIONS.items())


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(f"{PAGE.relative_to(PROJECT)}: {len(SECTIONS)} tables")
