"""Writes what type checkers and editors see of the modules that are made of the library's tables: python -m libdyn.stubs [FOLDER]

capi/python/build_backend does this when it builds the package, with the library that goes into it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from . import batch_methods, data_methods, joint_spec, model_arrays
from . import fields as field_module
from .interface import INTERFACE, public_name
from .messages import in_python
from .results import RESULTS
from .tables import ALGORITHMS, FIELDS, OPTIONAL, SHAPES, AlgorithmInfo

HEAD = "# Written by `python -m libdyn.stubs` from the library's tables.\n"
INPUTS = {"frame": "int | str", "joint": "int | str", "reference": "ReferenceLike", "integrator": "IntegratorLike", "dt": "float",
          "lam": "ArrayLike"}
INPUTS.update((name, "StateLike | None") for name in ("q", "v", "a", "tau"))


def _doc(text: str, indent: str) -> str:
    safe = text.replace("\\", "\\\\").replace('"""', "'''")
    return f'{indent}"""{safe}{" " if safe.endswith(chr(34)) else ""}"""' if safe else ""


def _block(*lines: str) -> str:
    return "\n".join(line for line in lines if line)


def enums() -> Iterator[str]:
    yield "import enum\nfrom collections.abc import Iterable\nfrom typing import Literal, Union\n"
    for described in INTERFACE["enums"]:
        name = public_name(described)
        masks = described["bits"] or max(v["value"] for v in described["values"]) > len(described["values"])
        yield _block(f"class {name}(enum.{'IntFlag' if masks else 'IntEnum'}):", _doc(in_python(described["doc"]), "    "))
        for value in described["values"]:
            yield _block(f"    {value['name']} = {value['value']}", _doc(in_python(value["doc"]), "    "))
        choices = f"Union[{name}, Literal[{', '.join(repr(v['name'].lower()) for v in described['values'])}]]"
        yield f"{name}Like = " + (f"Union[{choices}, int, Iterable[{choices}]]" if masks else choices)
    yield f"__all__ = {[public_name(described) for described in INTERFACE['enums']]}"


def abi() -> Iterator[str]:
    yield "from ctypes import Structure\nfrom typing import Any, TypedDict\n\nfrom numpy.typing import ArrayLike\n"
    yield "class Sized(Structure):\n    struct_size: int"
    numbers = {"double": "float", "const char*": "bytes | None"}
    for described in INTERFACE["structs"]:
        base = "Sized" if described["fields"][0]["name"] == "struct_size" else "Structure"
        yield _block(f"class {described['name'][3:]}({base}):", _doc(described["doc"], "    "))
        for field in described["fields"]:
            kind = field.get("type", "*")
            plain = "Any" if "length" in field or kind.endswith("*") and kind != "const char*" else numbers.get(kind, "int")
            yield _block(f"    {field['name']}: {'Any' if kind[3:] in STRUCTURES else plain}", _doc(field.get("doc", ""), "    "))
    yield "".join(f"{callback['name'][3:]}: Any\n" for callback in INTERFACE["callbacks"])
    yield "class JointValues(TypedDict, total=False):"
    for name, sentence in joint_spec.VALUES.items():
        yield _block(f"    {name}: {'float' if name in joint_spec.SCALARS else 'ArrayLike'} | None", _doc(sentence, "    "))
    yield "def initialized(structure: Any, *arguments: Any) -> Any: ..."


def arrays() -> Iterator[str]:
    yield "from .arrays import Numbers\nfrom .enums import ModelArray, ModelArrayLike\nfrom .handles import ModelHandle\n"
    yield "DESCRIBED: dict[ModelArray, tuple[str, str]]\n\nclass ModelArrays(ModelHandle):"
    yield _block("    def array(self, which: ModelArrayLike) -> Numbers:",
                 _doc(model_arrays.ModelArrays.array.__doc__ or "", "        "))
    for array, (size, sentence) in model_arrays.DESCRIBED.items():
        yield _block("    @property", f"    def {array.name.lower()}(self) -> Numbers:",
                     _doc(f"({size},): {sentence}", "        "))


STRUCTURES = {described["name"][3:] for described in INTERFACE["structs"]}


def results() -> Iterator[str]:
    yield "from typing import Any, NamedTuple\n\nfrom .arrays import Numbers\n\nRESULTS: dict[str, Any]"
    for algorithm, made in RESULTS.items():
        yield f"class {made.__name__}(NamedTuple):"
        for name, n in zip(ALGORITHMS[algorithm].outputs, ALGORITHMS[algorithm].dimensions):
            yield f"    {name}: {'Numbers' if n else 'float'}"
    yield "def turned(name: str, array: Numbers) -> Numbers: ...\ndef memory_address(a: Numbers) -> int | None: ..."


def fields() -> Iterator[str]:
    yield "from typing import Any\n\nfrom .arrays import Numbers, StateLike\nfrom .handles import DataHandle\nfrom .tables import FieldInfo\n"
    yield "STATE: dict[str, str]\n\ndef description(info: FieldInfo) -> str: ...\ndef attribute(name: str) -> str: ...\n\nclass Fields(DataHandle):"
    inputs = ", ".join(f"{name}: StateLike | None = None" for name in field_module.STATE.values())
    yield f"    def set_state(self, {inputs}) -> None:"
    yield _doc(field_module.Fields.set_state.__doc__ or "", "        ")
    yield _block("    @property", "    def state(self) -> dict[str, Numbers]:",
                 _doc(field_module.Fields.state.__doc__ or "", "        "))
    yield _block("    def field(self, field: str | int) -> Any:", _doc(field_module.Fields.field.__doc__ or "", "        "))
    for info in FIELDS.values():
        kind = "Numbers" if SHAPES[info.id] else "float"
        yield _block("    @property", f"    def {field_module.attribute(info.name)}(self) -> {kind}:", _doc(field_module.description(info), "        "))
        if info.name in field_module.STATE or info.name == "ctrl":
            yield f"    @{info.name}.setter\n    def {info.name}(self, value: Any) -> None: ..."


def _returns(algorithm: AlgorithmInfo, alone: bool) -> str:
    if algorithm.of_placements:
        return "Placement"
    if len(algorithm.outputs) > 1 and not alone:
        return f"results.{RESULTS[algorithm.name].__name__}"
    return "Numbers" if algorithm.dimensions[0] else "float"


_METHODS = (
    "from typing import Any, overload\n\nfrom numpy.typing import ArrayLike\n\nfrom . import results\n"
    "from .arrays import Integers, Numbers, Placement, StateLike\n"
    "from .enums import IntegratorLike, ReferenceLike\nfrom .handles import DataHandle\nfrom .tables import AlgorithmInfo\n"
)


def data() -> Iterator[str]:
    yield _METHODS + "\ndef method_name(algorithm: str) -> str: ...\n\nclass Algorithms(DataHandle):"
    for algorithm in ALGORITHMS.values():
        found = data_methods.parameters(algorithm)
        if found is None:
            continue
        inputs = []
        for parameter in data_methods.signature(found[0]):
            name, _, default = parameter.partition("=")
            kind = INPUTS.get(name, "ArrayLike | None")
            inputs += [f"{name}: {kind}" + (f" = {default}" if default else "")]
        name = data_methods.method_name(algorithm.name)
        returns = _returns(algorithm, algorithm.name in data_methods.FIRST_ALONE)
        yield _block(f"    def {name}({', '.join(['self', *inputs])}) -> {returns}:",
                     _doc(getattr(data_methods.Algorithms, name).__doc__, "        "))


def batch() -> Iterator[str]:
    yield _METHODS + "\nclass Algorithms:"
    for algorithm in ALGORITHMS.values():
        inputs = ["self"]
        for name in algorithm.inputs:
            kind = INPUTS.get(name, "ArrayLike").replace("StateLike | None", "ArrayLike")
            inputs += [f"{name}: {kind}" + (" | None = None" if name in OPTIONAL else "")]
        doc = _doc(batch_methods.description(algorithm), "        ")
        method = f"    def {algorithm.name}({', '.join(inputs)}, *, only: {{}}, out: Any = None, status: Integers | None = None, exact: bool = False, mocap: ArrayLike | None = None) -> {{}}:"
        if len(algorithm.outputs) == 1:
            kind = "Placement" if algorithm.of_placements else "Numbers"
            yield _block(method.format("str | None = None", kind), doc)
        else:
            yield _block("    @overload", method.format("None = None", f"results.{RESULTS[algorithm.name].__name__}"), doc)
            yield _block("    @overload", method.format("str", "Numbers") + " ...")


STUBS = {"enums": enums, "abi": abi, "results": results, "fields": fields, "model_arrays": arrays, "data_methods": data,
         "batch_methods": batch}


def write(folder: Path) -> None:
    """Writes all of them into a folder."""
    for name, lines in STUBS.items():
        (folder / f"{name}.pyi").write_text(HEAD + "\n".join(line for line in lines() if line) + "\n", encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
