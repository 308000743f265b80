"""Texts of the library in Python's words: base="fixed" for DYN_BASE_FIXED, Data.crba for dyn_crba, None for NULL.

Everything follows from the library's description of its interface, but for the few names in DIFFERENT.
"""

from __future__ import annotations

import re
from typing import Any

from .interface import FUNCTIONS, INTERFACE, public_name
from .tables import FIELDS

OWNERS = {
    "model": "Model", "data": "Data", "builder": "Builder", "batch": "Batch", "mesh": "Mesh", "contact_solver": "ContactSolver",
    "broad_phase": "BroadPhase", "se3": "Placement",
    "planner": "Planner",
}  # fmt: skip
"""Class of the functions dyn_model_..., dyn_data_..., and so on."""
DIFFERENT = {
    "dyn_planner_new": "Model.planner", "dyn_planner_init": "Model.planner", "dyn_planner_size": "Model.planner",
    "dyn_data_new": "Model.data", "dyn_data_init": "Model.data", "dyn_data_size": "Model.data_size",
    "dyn_data_array": "Data.field", "dyn_data_pair": "Data.pair_reason", "dyn_data_effect_info": "Data.plan",
    "dyn_effect_count": "Data.plan", "dyn_field_id": "Data.field", "dyn_batch_new": "Model.batch", "dyn_batch_run": "dyn.Batch",
    "dyn_builder_new": "dyn.Builder", "dyn_builder_set_shape_rgba": "Builder.add_shape",
    "dyn_builder_set_shape_fluid": "Builder.add_shape",
    "dyn_contact_stiffness_hertz": "dyn.contact_compliance_hertz", "dyn_contact_solver_new": "dyn.ContactSolver",
    "dyn_contact_solver_init": "dyn.ContactSolver", "dyn_contact_solver_size": "ContactSolver.bytes",
    "dyn_broad_phase_new": "dyn.BroadPhase", "dyn_mesh_load": "dyn.load_mesh", "dyn_mesh_rgb": "Mesh.colours",
    "dyn_mesh_from_height_field": "Mesh.height_field", "dyn_model_load": "dyn.load", "dyn_model_load_string": "dyn.load_string",
    "dyn_model_save_memory": "Model.to_bytes", "dyn_model_report_count": "Model.report", "dyn_model_report_entry": "Model.report",
    "dyn_model_frame_id_of_type": "Model.frame_id", "dyn_model_shape_rgba": "Model.shape",
    "dyn_model_ndisabled_pairs": "Model.disabled_pairs", "dyn_model_disabled_pair": "Model.disabled_pairs",
    "dyn_model_nconfigurations": "Model.configuration_names", "dyn_model_pair": "Model.pairs",
    "dyn_model_configuration_name": "Model.configuration_names", "dyn_model_constraint_name": "Model.constraint_names",
    "dyn_builder_add_actuator_between": "Builder.add_actuator", "dyn_model_actuator_name": "Model.actuator_names",
    "dyn_model_tendon_name": "Model.tendon_names", "dyn_model_tendon_element": "Model.tendon",
    "dyn_model_sensor_name": "Model.sensor_names", "dyn_sensor_noise": "Data.noisy_sensors",
    "dyn_sensor_delay": "Model.delayed_sensors", "dyn_model_nforce_limits": "Model.force_limits",
    "dyn_model_force_limit_info": "Model.force_limits",
    "dyn_model_state_size": "Data.save_state",
    "dyn_state_layout_sizes": "StateLayout.sizes", "dyn_state_layout_convert": "Model.to_peer", "dyn_field_info": "dyn.FIELDS",
    "dyn_builder_parameter_count": "Builder.parameters", "dyn_builder_parameter": "Builder.parameters",
    "dyn_field_count": "dyn.FIELDS", "dyn_algorithm_info": "dyn.ALGORITHMS", "dyn_algorithm_run": "dyn.ALGORITHMS",
    "dyn_effect_type_info": "dyn.Effect", "dyn_sensor_size": "dyn.SensorType", "dyn_version": "dyn.__version__",
    "dyn_mesh_arrays": "Mesh.vertices", "dyn_status_name": "dyn.Status", "dyn_so3_exp": "spatial.exp3", "dyn_so3_log": "spatial.log3",
    "dyn_so3_jexp": "spatial.Jexp3", "dyn_so3_jlog": "spatial.Jlog3", "dyn_so3_interpolate": "spatial.interpolate",
    "dyn_so3_from_quaternion": "spatial.quaternion_to_matrix", "dyn_so3_to_quaternion": "spatial.matrix_to_quaternion",
    "dyn_so3_from_rpy": "spatial.rpy_to_matrix", "dyn_so3_to_rpy": "spatial.matrix_to_rpy", "dyn_se3_exp": "spatial.exp6",
    "dyn_se3_log": "spatial.log6", "dyn_se3_jexp": "spatial.Jexp6", "dyn_se3_jlog": "spatial.Jlog6",
    "dyn_se3_compose": "Placement.__matmul__", "dyn_se3_to_matrix": "Placement.matrix", "dyn_se3_to_quaternion": "Placement.quaternion",
    "dyn_se3_to_rpy": "Placement.rpy",
}  # fmt: skip
"""Functions whose names in Python do not follow from those in C."""


_ENUMS = {enum["name"]: public_name(enum) for enum in INTERFACE["enums"]}


def _function(name: str) -> str:
    if name in DIFFERENT:
        return DIFFERENT[name]
    if name not in FUNCTIONS:
        return name
    short, types = name[4:], [p.get("type", "") for p in FUNCTIONS[name]["parameters"][:2]] + ["", ""]
    if name.endswith("_info") and types[0] in _ENUMS:
        return f"dyn.{_ENUMS[types[0]]}"
    for prefix, owner in OWNERS.items():
        if short.startswith(f"{prefix}_"):
            return f"{owner}.{re.sub('_info$', '', short[len(prefix) + 1 :])}"
    if types[1].endswith("dynData*"):
        return f"Data.compute_{short}" if short in FIELDS else f"Data.{short}"
    return f"Model.{short.removeprefix('configuration_')}" if types[0] == "const dynModel*" else f"dyn.{short}"


def _arguments() -> dict[str, set[str]]:
    """For each enumeration the arguments that take it: parameters of functions, members of structures that a caller fills."""
    found: dict[str, set[str]] = {}
    filled = {f["parameters"][0]["type"] for name, f in FUNCTIONS.items() if name.endswith("_init")}
    declared = ([f["parameters"] for f in FUNCTIONS.values()]
                + [s["fields"] for s in INTERFACE["structs"] if f"{s['name']}*" in filled])
    for x in (x for each in declared for x in each):
        found.setdefault(x.get("type", ""), set()).add(x["name"])
    return found


def _members() -> dict[str, str]:
    """Each value of an enumeration, as it is given in Python."""
    words, arguments = {}, _arguments()
    for enum in INTERFACE["enums"]:
        names = arguments.get(enum["name"], set())
        for value in enum["values"]:
            if enum["bits"] or not names or enum["name"] == "dynStatus":
                words[value["identifier"]] = f"dyn.{public_name(enum)}.{value['name']}"
            else:
                words[value["identifier"]] = (f"{min(names)}=" if len(names) == 1 else "") + f'"{value["name"].lower()}"'
    return words


MEMBERS = _members()
_PREFIXES = {enum["prefix"]: public_name(enum) for enum in INTERFACE["enums"]}
_TYPES = {x["name"] for kind in ("enums", "structs", "handles") for x in INTERFACE[kind]}
_WORDS = re.compile(
    r"(?P<shell> \(--\w+\)|; on the command line --\w+ or --\w+)"
    r"|(?P<some>DYN_[A-Z_]+_)\.\.\. values?"
    r"|(?P<first>DYN_[A-Z0-9_]+)(?P<more>(?:, _[A-Z0-9_]+)+)"
    r"|(?:\w+ = )?(?P<member>DYN_[A-Z0-9_]+)"
    r"|(?P<function>dyn_[a-z0-9_]+)"
    r"|(?P<type>\bdyn[A-Z]\w+)"
    r"|(?P<null>\bNULL\b)"
    r"|\bbase (?P<base>fixed|floating)\b"
)


def _list(first: str, more: str) -> str:
    """DYN_X_A, _B, _C: names in quotes."""
    prefix = max((p for p in _PREFIXES if first.startswith(p)), key=len, default="")
    return ", ".join(f'"{name.lower()}"' for name in [first[len(prefix) :], *more.replace(", _", " ").split()])


def _word(found: re.Match) -> str:
    kind, text = found.lastgroup, found.group()
    if kind == "shell":
        return ""
    if kind == "null":
        return "None"
    if kind == "base":
        return f'base="{found["base"]}"'
    if kind == "some":
        return f"members of dyn.{_PREFIXES.get(found['some'], '')}"
    if kind == "more":
        return _list(found["first"], found["more"])
    if kind == "member":
        return MEMBERS.get(found["member"], text)
    if kind == "function":
        return _function(text)
    return f"dyn.{text[3:]}" if text in _TYPES else text


def in_python(text: str) -> str:
    """A text of the library in Python's words."""
    return _WORDS.sub(_word, text)


def document(enums: dict[str, Any]) -> None:
    """Translates what help() says of enumerations and their members; enums: {name: enumeration}."""
    described = [x for enum in enums.values() for x in (enum, *enum)]
    for x, text in zip(described, in_python("\0".join(x.__doc__ or "" for x in described)).split("\0")):
        x.__doc__ = text
