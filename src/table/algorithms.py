"""Rows of dynAlgorithm, made of its comments and of prototypes in dyn.h: algorithms.inc, for capi/batch_algorithms.cpp.

A comment is  PART: inputs -> outputs; after FUNCTIONS  (dyn.h says how). An output is a name and one to three sizes.
"""
import re
import sys

OUTPUT = re.compile(r"(\w+) (\w+)(?: x (\w+))?(?: x (\w+))?$")
SIZES = {"nq", "nv", "njoints", "nframes", "nparameters", "ntendons", "nsensordata"}
OPTIONS = {"frame", "joint", "reference", "dt", "integrator"}
STATES = {"q", "v", "a", "tau", "fext", "b", "q1"}
ALIASES = {"lambda": "b", "q0": "q"}  # parameters whose input has another name


class Algorithm:
    def __init__(self, value):
        self.name, self.id = value["name"].lower(), value["identifier"]
        text, _, after = value["doc"].partition("; after ")
        part, colon, text = text.rpartition(": ")
        inputs, arrow, outputs = text.partition(" -> ")
        self.part = f"DYN_PART_{part}" if colon else "0"
        self.inputs = re.split("[,;] ", inputs)
        self.outputs = [OUTPUT.match(output) for output in outputs.split(", ")]
        self.after = after.split(", ") if after else []
        if not arrow or not all(self.outputs) or len(self.outputs) > 4:
            sys.exit(f'dyn.h: the comment of {self.id} is no "PART: inputs -> outputs; after FUNCTIONS": {value["doc"]}')
        for name in set(self.inputs) - OPTIONS - STATES:
            sys.exit(f"dyn.h: {self.id} reads '{name}', which dynBatchArrays does not have")

    def extent(self, match):
        def size(word):
            if not word.isdigit() and word not in SIZES:
                sys.exit(f"dyn.h: {self.id}: the size '{word}' of {match.group(1)} is none of {', '.join(sorted(SIZES))}")
            return word if word.isdigit() else f"s.{word}"
        sizes = [size(word) for word in match.groups()[1:] if word]
        sizes += ["1"] * (2 - len(sizes))
        return f'{{"{match.group(1)}", []([[maybe_unused]] const Sizes& s) {{ return Extent{{{", ".join(sizes)}}}; }}}}'

    def given(self, parameter, outputs):
        """What the call gives for a parameter of the function. outputs: where results go, or nullptr for a call made first."""
        name = ALIASES.get(parameter["name"], parameter["name"])
        if name in ("model", "data"):
            return name
        if name in self.inputs and "const double" in parameter["type"] or name in OPTIONS:
            return f"x.{name}"
        if name == "nrhs":
            return "1"
        return "nullptr" if "const double" in parameter["type"] or outputs is None else next(outputs)

    def call(self, functions):
        steps = []
        for name in self.after + [f"dyn_{self.name}"]:
            if name not in functions:
                sys.exit(f"dyn.h: {self.id}: there is no function {name}")
            last = name == f"dyn_{self.name}"
            outputs = iter([f"x.out[{k}]" for k in range(len(self.outputs))]) if last else None
            arguments, before = [], ""
            for p in functions[name]["parameters"]:
                struct = re.match(r"const (dyn\w+)\*$", p["type"])
                if struct and p["name"] not in ("model", "data"):
                    before = f'const {struct.group(1)} out = {{sizeof(out), {", ".join(outputs)}}}; '
                    arguments.append("&out")
                else:
                    arguments.append(self.given(p, outputs))
            call = f'{name}({", ".join(arguments)})'
            steps.append(f"{before}return {call};" if last else f"if (const dynStatus s = {call}) return s;")
        parameters = ", ".join(f"[[maybe_unused]] {p}" for p in ("const dynModel* model", "dynData* data", "const dynBatchArrays& x"))
        return f'[]({parameters}) -> dynStatus {{ {" ".join(steps)} }}'

    def row(self, functions):
        outputs = ",\n      ".join(self.extent(output) for output in self.outputs)
        return (f'    {{"{self.name}", "{" ".join(self.inputs)}", {self.part}, "{" ".join(self.after)}",\n     {{{outputs}}},\n'
                f"     one_state<{self.id}>({self.call(functions)})}},")


def rows(header):
    functions = {function["name"]: function for function in header.functions}
    enum = next(enum for enum in header.enums if enum["name"] == "dynAlgorithm")
    for k, value in enumerate(enum["values"]):
        if value["value"] != k:
            sys.exit(f"dyn.h: {value['identifier']} is not {k}: algorithms are numbered without gaps")
        yield Algorithm(value).row(functions)
