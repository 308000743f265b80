"""The reference of the Python package as Markdown: what `import libdyn` gives, with signatures and the first paragraph of each docstring.
Read from the sources, without the library.   python.py OUT"""

import ast
import sys
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "capi/python/libdyn"


def exported():
    """(name, module) of what __init__ takes from modules of the package."""
    tree = ast.parse((PACKAGE / "__init__.py").read_text(encoding="utf-8"))
    for node in tree.body:
        if isinstance(node, ast.ImportFrom) and node.level and node.module:
            yield from ((alias.name, node.module) for alias in node.names)


def paragraph(node):
    return " ".join((ast.get_docstring(node) or "").split("\n\n")[0].split())


def signature(node):
    return f"{node.name}({ast.unparse(node.args)})" + (f" -> {ast.unparse(node.returns)}" if node.returns else "")


def is_public(node):
    return isinstance(node, ast.FunctionDef) and not node.name.startswith("_")


def members(node, classes):
    """Methods and properties, those of mixins of the package included."""
    for base in node.bases:
        if isinstance(base, ast.Name) and base.id in classes:
            yield from members(classes[base.id], classes)
    for one in node.body:
        if is_public(one) and not any(ast.unparse(d).endswith(".setter") for d in one.decorator_list):
            yield one


def entry(node, classes):
    if isinstance(node, ast.FunctionDef):
        return f"### {node.name}\n\n```python\n{signature(node)}\n```\n\n{paragraph(node)}\n"
    lines = [f"### {node.name}\n", paragraph(node) + "\n"]
    for one in members(node, classes):
        is_property = any("property" in ast.unparse(d) for d in one.decorator_list)
        lines.append(f"- `{one.name if is_property else signature(one).replace('(self, ', '(').replace('(self)', '()')}`  \n  {paragraph(one)}")
    return "\n".join(lines) + "\n"


def main(out):
    trees = {f.stem: ast.parse(f.read_text(encoding="utf-8")) for f in PACKAGE.glob("*.py")}
    kinds = (ast.ClassDef, ast.FunctionDef)
    nodes = {(module, n.name): n for module, tree in trees.items() for n in tree.body if isinstance(n, kinds)}
    classes = {n.name: n for n in nodes.values() if isinstance(n, ast.ClassDef)}
    found = sorted(((name, nodes[module, name]) for name, module in exported() if (module, name) in nodes), key=lambda x: x[0].lower())
    text = "# Python\n\nWhat `import libdyn as dyn` gives. Fields, algorithms and enumerations are those of [dyn.h](reference/index.html).\n"
    for title, kind in (("Classes", ast.ClassDef), ("Functions", ast.FunctionDef)):
        text += f"\n## {title}\n\n" + "\n".join(entry(n, classes) for _, n in found if isinstance(n, kind))
    Path(out).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
