#!/usr/bin/env python3
"""Reads dyn.h and writes what it declares as tables:  reflect.py dyn.h FOLDER

  members.inc    values of each enumeration, for range checks (enums.hpp)
  names.inc      names of the values of each enumeration (names.hpp)
  statuses.inc   identifiers of dynStatus (capi/message.cpp)
  enums.inc      names and sentences of enumerations (capi/reflection.cpp)
  algorithms.inc rows of dynAlgorithm (algorithms.py)
  functions.inc  names of the functions (capi/level)
  functions.def  the same, as what a library of Windows exports
  interface.inc  the whole interface as JSON, a C++ string (dyn_interface_json in dyn.h says what it holds)

A comment that ends on the line above a declaration describes it; so does one that begins behind it on its last line.
"""
import json
import os
import re
import sys

import algorithms

TOKEN = re.compile(r'(?P<comment>/\*.*?\*/)|(?P<directive>^[ \t]*#(?:\\\n|/(?!\*)|[^/\n])*)|(?P<string>"[^"]*")'
                   r'|(?P<word>\w+)|(?P<space>\s+)|(?P<sign>.)', re.S | re.M)


class Token:
    def __init__(self, kind, text, line):
        self.kind, self.text, self.line, self.end = kind, text, line, line + text.count("\n")


def tokens_of(text):
    line = 1
    for match in TOKEN.finditer(text):
        if match.lastgroup != "space":
            yield Token(match.lastgroup, match.group(), line)
        line += match.group().count("\n")


def plain(comment, lines=False):
    """A comment's text: in one line, or as it lies."""
    rows = [row.strip() for row in comment[2:-2].strip().split("\n")]
    if lines:
        rows = [re.sub(r"^( {3}| \* ?)", "", row.rstrip()) for row in comment[2:-2].strip().split("\n")]
        return "\n".join(rows)
    return " ".join(row for row in rows if row)


class Header:
    """Declarations of a C header, in its order."""

    def __init__(self, text):
        every = list(tokens_of(text))
        self.code = [t for t in every if t.kind not in ("comment", "directive")]
        self.constants, self.macros, self.enums, self.structs = [], [], [], []
        self.handles, self.types, self.callbacks, self.functions = [], [], [], []
        self.values, self.inherited = {}, ""
        self.attach(every)
        self.directives([t for t in every if t.kind == "directive"])
        self.declarations()

    # ------------------------------------------------------------------------------------------------ comments

    def attach(self, every):
        """Gives each token the comment above it and the one behind it."""
        for token in every:
            token.above = token.behind = token.section = ""
        last = None
        for k, token in enumerate(every):
            if token.kind != "comment":
                last = token
                continue
            follower = next((t for t in every[k + 1:] if t.kind != "comment"), None)
            if last and last.end == token.line:
                last.behind += token.text
            elif follower and token.end >= follower.line - 1:
                follower.above = token.text
        section = ""
        for token in every:
            found = token.kind == "comment" and re.match(r"/\* -{9,} (.*) \*/$", token.text)
            section = found.group(1) if found else section
            token.section = section

    def doc(self, tokens, lines=False):
        behind = tokens[-1].behind or (tokens[-2].behind if len(tokens) > 1 and tokens[-1].text in ",;" else "")
        comment = tokens[0].above or behind
        return plain(comment, lines) if comment and "-----" not in comment else ""

    # ------------------------------------------------------------------------------------------------ preprocessor

    def directives(self, directives):
        for token in directives:
            found = re.match(r"\s*#\s*define\s+(DYN_\w+)(\([^)]*\))?\s*(.*)", token.text, re.S)
            if not found:
                continue
            name, parameters, body = found.groups()
            body = re.sub(r"\\\n\s*", "", body).strip()
            if name.startswith("DYN_") and not parameters and re.match(r"[-\d.]", body):
                self.constants.append({"name": name, "value": self.number(body), "doc": plain(token.behind) if token.behind else self.doc([token])})
        for token in directives:
            found = re.match(r"\s*#\s*define\s+(dyn_\w+)\(([^)]*)\)\s*(.*)", token.text, re.S)
            if found:
                name, parameters, body = found.groups()
                self.macros.append({"name": name, "parameters": [p.strip() for p in parameters.split(",")],
                                    "body": re.sub(r"\s*\\\n\s*", " ", body).strip(), "doc": self.doc([token])})

    def number(self, text):
        text = re.sub(r"\b(0x[0-9a-fA-F]+|\d+)[uUlL]+\b", r"\1", text)
        return eval(text, {"__builtins__": {}}, self.values)

    # ------------------------------------------------------------------------------------------------ declarations

    def declarations(self):
        k = 0
        while k < len(self.code):
            if self.code[k].text == "extern":  # extern "C" {
                k += 3
                continue
            if self.code[k].text == "}":
                k += 1
                continue
            end = self.end_of(k)
            tokens = self.code[k:end]
            follows = k and tokens[0].line == self.code[k - 1].end + 1  # a function without a comment, right below another declaration, has the other's
            self.inherited = self.doc(tokens, True) or (self.inherited if follows else "")
            self.declare(tokens)
            k = end

    def end_of(self, k):
        depth = 0
        while True:
            text = self.code[k].text
            depth += (text in "({") - (text in ")}")
            if text == ";" and depth == 0:
                return k + 1
            if text == "}" and depth == 0 and self.code[k + 1].text not in ("dyn", ";") and self.code[k + 1].kind != "word":
                return k + 1
            k += 1

    def declare(self, tokens):
        words = [t.text for t in tokens]
        if words[0] in ("static", "inline"):
            return
        if words[0] == "DYN_API":
            self.function(tokens)
        elif words[0] == "enum":
            self.enum("", tokens)
        elif words[:2] == ["typedef", "enum"]:
            self.enum(words[-2], tokens)
        elif words[:2] == ["typedef", "struct"] and "{" in words:
            self.struct(words[-2], tokens)
        elif words[:2] == ["typedef", "struct"]:
            self.handles.append({"name": words[-2], "doc": self.doc(tokens, True)})
        elif words[0] == "typedef" and "(" in words:
            self.callbacks.append({**self.declarator(tokens[1:-1], []), "doc": self.doc(tokens, True)})
        elif words[0] == "typedef":
            self.types.append({"name": words[-2], "type": " ".join(words[1:-2]), "doc": self.doc(tokens, True)})
        else:
            sys.exit(f"dyn.h:{tokens[0].line}: what is declared here?")

    def split(self, tokens, separator):
        """Parts between separators outside of brackets; each with its separator, if one follows."""
        part, depth = [], 0
        for token in tokens:
            depth += (token.text in "([{") - (token.text in ")]}")
            part.append(token)
            if token.text == separator and depth == 0:
                yield part
                part = []
        if part:
            yield part

    def enum(self, name, tokens):
        begin = next(k for k, t in enumerate(tokens) if t.text == "{")
        end = max(k for k, t in enumerate(tokens) if t.text == "}")
        values, following = [], 0
        for part in self.split(tokens[begin + 1:end], ","):
            words = [t.text for t in part if t.text != ","]
            value = self.number("".join(words[2:])) if len(words) > 1 else following
            self.values[words[0]] = value
            following = value + 1
            values.append({"identifier": words[0], "value": value, "doc": self.doc(part)})
        if not name and len(values) == 1:
            self.constants.append({"name": values[0]["identifier"], "value": values[0]["value"], "doc": self.doc(tokens)})
            return
        bits = not name
        prefix = "DYN" + re.sub(r"([A-Z])", r"_\1", name[3:]).upper() + "_"
        if bits:
            prefix = re.match(r"DYN_[A-Z]+_", values[0]["identifier"]).group()
            name = "dyn" + prefix[4:-1].title() + "s"
        if not all(v["identifier"].startswith(prefix) for v in values):
            prefix = "DYN_"
        doc = self.doc(tokens, True) or next((t["doc"] for t in self.types if t["name"] == name), "")
        self.enums.append({"name": name, "prefix": prefix, "bits": int(bits), "doc": doc, "values": [
            {"identifier": v["identifier"], "name": v["identifier"][len(prefix):], "value": v["value"], "doc": v["doc"]} for v in values]})

    def struct(self, name, tokens):
        begin = next(k for k, t in enumerate(tokens) if t.text == "{")
        fields = []
        for part in self.split(tokens[begin + 1:-3], ";"):
            doc, base = self.doc(part), []
            for one in self.split([t for t in part if t.text != ";"], ","):
                fields.append({**self.declarator([t for t in one if t.text != ","] if len(one) and one[-1].text == "," else one, base), "doc": doc})
        self.structs.append({"name": name, "doc": self.doc(tokens, True), "fields": fields})

    def declarator(self, tokens, base):
        """One variable: name, type, array length. base: the type's words, set by the first of several."""
        words = [t.text for t in tokens if t.text != "struct"]
        if "(" in words:  # a pointer to a function: returns (*name)(parameters)
            k = words.index("(")
            tokens = [t for t in tokens if t.text != "struct"]
            return {"name": words[k + 2], "returns": self.type_of(words[:k]), "parameters": self.parameters(tokens[k + 5:-1])}
        length = []
        while words[-1] == "]":
            k = len(words) - 1 - words[::-1].index("[")
            length.insert(0, self.number("".join(words[k + 1:-1])))
            del words[k:]
        name, kind = words[-1], words[:-1]
        if not base:
            base.extend(kind[:kind.index("*")] if "*" in kind else kind)
        else:
            kind = base + kind
        return {"name": name, "type": self.type_of(kind), **({"length": length} if length else {})}

    @staticmethod
    def type_of(words):
        return " ".join(words).replace(" *", "*")

    def parameters(self, tokens):
        parts = [[t for t in part if t.text != ","] if part[-1].text == "," else part for part in self.split(tokens, ",")]
        return [] if [t.text for t in tokens] == ["void"] else [self.declarator(part, []) for part in parts]

    def function(self, tokens):
        words = [t.text for t in tokens]
        k = words.index("(")
        self.functions.append({"name": words[k - 1], "returns": self.type_of([w for w in words[1:k - 1] if w != "struct"]),
                               "parameters": self.parameters(tokens[k + 1:-2]), "section": tokens[0].section, "doc": self.inherited})


# ---------------------------------------------------------------------------------------------------- the tables

def quoted(text):
    return json.dumps(text, ensure_ascii=False)


def members(header):
    """Range checks: which integers are values."""
    for enum in header.enums:
        values = sorted({v["value"] for v in enum["values"]})
        if enum["bits"]:
            total = 0
            for value in values:
                total |= value
            yield f'inline constexpr unsigned {enum["prefix"].lower()}bits = {total:#x};'
            continue
        dense = values == list(range(values[0], values[-1] + 1))
        test = f"x >= {values[0]} && x <= {values[-1]}" if dense else " || ".join(f"x == {v}" for v in values)
        yield (f'template <>\nstruct Members<{enum["name"]}> {{\n  static constexpr const char* type = "{enum["name"]}";\n'
               f"  static constexpr int first = {values[0]}, last = {values[-1]}, count = {len(values)};\n"
               f"  static constexpr bool has(int x) {{ return {test}; }}\n}};")


def names(header):
    for enum in (e for e in header.enums if not e["bits"]):  # names of bits are no types
        values = ", ".join(f'{{"{v["name"].lower()}", {v["value"]}}}' for v in enum["values"])
        yield f'template <>\ninline constexpr ValueName value_names<{enum["name"]}>[] = {{{values}}};'


def statuses(header):
    values = next(e["values"] for e in header.enums if e["name"] == "dynStatus")
    assert [v["value"] for v in values] == list(range(len(values)))
    return (f'"{v["identifier"]}",' for v in values)


def enumerations(header):
    yield "const EnumValue enum_values[] = {"
    for enum in header.enums:
        for v in enum["values"]:
            yield f'    {{"{v["identifier"]}", "{v["name"].lower()}", {v["value"]}, {quoted(v["doc"])}}},'
    yield "};\nconst Enum enums[] = {"
    first = 0
    for enum in header.enums:
        sentence = enum["doc"].replace("\n", " ")
        yield f'    {{"{enum["name"]}", "{enum["prefix"]}", {enum["bits"]}, {first}, {len(enum["values"])}, {quoted(sentence)}}},'
        first += len(enum["values"])
    yield "};"


def functions(header):
    return (f"FUNCTION({function['name']})" for function in header.functions)


def interface(header):
    text = json.dumps({"constants": header.constants, "macros": header.macros, "enums": header.enums, "handles": header.handles, "types": header.types,
                       "callbacks": header.callbacks, "structs": header.structs, "functions": header.functions},
                      ensure_ascii=False, separators=(",", ":"))
    yield f'R"json({text})json"'


def write(path, first, rows):
    """Only where the text changes, so that what includes it is not built again for nothing."""
    text = "\n".join([first, *rows]) + "\n"
    if not os.path.exists(path) or open(path, encoding="utf-8").read() != text:
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


def main(path, folder):
    header = Header(open(path, encoding="utf-8").read())
    os.makedirs(folder, exist_ok=True)
    tables = {"members": members, "names": names, "statuses": statuses, "enums": enumerations, "algorithms": algorithms.rows,
              "functions": functions, "interface": interface}
    for name, rows in tables.items():
        write(os.path.join(folder, name + ".inc"), "// Made of dyn.h by src/table/reflect.py.", rows(header))
    write(os.path.join(folder, "functions.def"), "EXPORTS", (function["name"] for function in header.functions))


if __name__ == "__main__":
    main(*sys.argv[1:])
