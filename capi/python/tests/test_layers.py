"""How the package is put together: modules import one another in one direction, and nothing hides a method."""

import ast
from pathlib import Path

import libdyn as dyn

PACKAGE = Path(dyn.__file__).parent


def imports(file):
    """Modules of the package that a module imports when it runs, at its top or in a function; not those for type checkers
    alone."""
    found, nodes = set(), [ast.parse(file.read_text(encoding="utf-8"))]
    while nodes:
        node = nodes.pop()
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            continue
        if isinstance(node, ast.ImportFrom) and node.level:
            found |= {node.module} if node.module else {a.name for a in node.names}
        nodes += ast.iter_child_nodes(node)
    return found


def test_modules_import_in_one_direction():
    graph = {file.stem: imports(file) for file in PACKAGE.glob("*.py") if file.stem != "__init__"}
    done = set()
    while graph:
        free = {name for name, needed in graph.items() if needed <= done}
        assert free, f"these modules import one another: {sorted(graph)}"
        done |= free
        graph = {name: needed for name, needed in graph.items() if name not in free}


def test_files_are_short():
    assert max(len(file.read_text(encoding="utf-8").splitlines()) for file in PACKAGE.glob("*.py")) < 450


def test_no_field_hides_a_method():
    """Where a method's name is also a field's, the method is compute_<name>."""
    fields = {cls for cls in dyn.Data.__mro__ if cls.__name__ == "Fields"}
    for cls in set(dyn.Data.__mro__) - fields:
        assert not dyn.FIELDS.keys() & vars(cls).keys(), cls
    assert all(hasattr(dyn.Data, f"compute_{name}") for name in dyn.ALGORITHMS.keys() & dyn.FIELDS.keys())
