"""Seeded mutations of single expressions."""
import hashlib
import re

SWAPPED = {"+": "-", "-": "+", "*": "/", "/": "*", "<=": "<", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&",
           "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
FUNCTIONS = {"min": "max", "max": "min", "sin": "cos", "cos": "sin"}
TYPES = set("double float int Index bool T S void auto char const unsigned long typename size_t".split())
NOT_VALUES = {"return", "case", "throw", "else", "in", "and", "or", "not", "sizeof", "new", "delete", "co_return", "operator"}


class Mutant:
    kind = "expression"

    def __init__(self, file, line, part, site, change, text, before):
        self.file, self.line, self.part, self.site, self.change = file, line, part, site, change
        self.text = text      # what changes, for the table
        self.key = f"{file}: {before}: {text}"


def ends_value(token):
    return token.kind in ("name", "number") and token.text not in NOT_VALUES or token.text in (")", "]")


def changes_at(r, part, i):
    """(text of the change, replacements by token) of each mutation at token i."""
    token, before, after = r.t[i], r.t[i - 1], r.t[i + 1] if i + 1 < len(r.t) else None
    word, inside = token.text, i > part.begin
    if token.conditional:
        return
    if token.kind == "sign" and inside and after:
        spaced = before.end < token.begin and token.end < after.begin
        binary = ends_value(before) and before.text not in TYPES and after.text not in (">", ",", ")")
        if word in ("<", ">") and spaced:
            yield f"{word} to {word}=", {i: word + "="}
            yield f"{word} to {'>' if word == '<' else '<'}", {i: ">" if word == "<" else "<"}
        elif word in SWAPPED and spaced and binary:
            yield f"{word} to {SWAPPED[word]}", {i: SWAPPED[word]}
    if word == "-" and after and not (inside and ends_value(before)) and token.end == after.begin:
        yield f"-{after.text} to {after.text}", {i: "+"}
    if word == "!" and part.kind == "condition":
        yield f"!{after.text} to {after.text}", {i: "!!"}
    if token.kind == "name" and word in FUNCTIONS and after and after.text in ("(", "<") and before.text == "::":
        yield f"{word} to {FUNCTIONS[word]}", {i: FUNCTIONS[word]}
    enclosed = before.text in ("[", "<", ".") or after is not None and after.text in ("]", ">")
    if token.kind == "number" and not enclosed and re.fullmatch(r"[0-9.]+(e-?[0-9]+)?", word) and float(word):
        other = "1" if word == "0.5" else f"2 * {word}"
        if "." in word or "e" in word or float(word) > 1:
            yield f"{word} to {other}", {i: f"({other})"}


def found(file, text, r):
    """All mutations of a source."""
    from mutation.source import line_of
    for part in r.parts:
        words = r.written(part.begin, part.end)
        assigned = [w for w in ("+=", "-=", "*=") if f" {w} " in words]
        line = line_of(text, r.t[part.begin].begin)
        if part.kind == "statement" and assigned and "{" not in words and not r.t[part.begin].conditional:
            yield Mutant(file, line, part, part.begin, None, f"without {words}", words)
        for i in range(part.begin, part.end):
            for name, change in changes_at(r, part, i):
                around = r.written(max(part.begin, i - 6), min(part.end, i + 7))
                at = sum(1 for k in range(part.begin, i) if r.word(k) == r.word(i))
                yield Mutant(file, line_of(text, r.t[i].begin), part, i, change, f"{name} in {around}", f"{words} #{at}")


def chosen(mutants, seed, count):
    """count of them, at most one of a part, by a hash of each: a change of the sources hardly changes the others."""
    order = sorted(mutants, key=lambda m: hashlib.sha256(f"{seed} {m.key}".encode()).digest())
    taken, keys, out = set(), set(), []
    for m in order:
        place = m.file, m.part.begin
        if place not in taken and m.key not in keys:
            taken.add(place), keys.add(m.key)
            out.append(m)
            if len(out) == count:
                break
    return out


def added(file, text, r, old, new):
    """The mutant that writes old as new in the smallest part that holds it."""
    from mutation.source import line_of
    holding = [p for p in r.parts if old in r.written(p.begin, p.end)]
    if not holding:
        raise SystemExit(f"tests/mutants.txt: nothing in {file} holds `{old}`")
    part = min(holding, key=lambda p: p.end - p.begin)
    m = Mutant(file, line_of(text, r.t[part.begin].begin), part, part.begin, r.written(part.begin, part.end).replace(old, new, 1),
               f"{old} to {new}", "added")
    return m


def edit(r, part, mutants):
    """Text in place of the part, and tokens behind it that it replaces. mutants: (number, mutant)."""
    original = r.original(part.begin, part.end)
    if part.kind == "statement":
        out = f"{{ {original}; }}"
        for number, m in mutants:
            if m.change is None:
                out = f"{{ if (!mutants::on({number})) {out} }}"
            else:
                out = f"{{ if (mutants::on({number})) {{ {changed(r, part, m)}; }} else {out} }}"
        return out, 1  # with its semicolon
    out = f"({original})"
    for number, m in mutants:
        out = f"(mutants::on({number}) ? ({changed(r, part, m)}) : {out})"
    return out, 0


def changed(r, part, m):
    return m.change if isinstance(m.change, str) else r.written(part.begin, part.end, m.change)
