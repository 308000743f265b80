"""Tuning constants: `constexpr double|int|Index ... name = value`, each raised and lowered."""
import re

TYPES = ("double", "float", "int", "Index", "unsigned", "long", "std::ptrdiff_t", "std::size_t")
WORDS = {"inline", "static", "constexpr"}


class Constant:
    kind = "constant"

    def __init__(self, file, line, name, type_, local, value):
        self.file, self.line, self.name, self.type, self.local, self.value = file, line, name, type_, local, value
        self.real = type_ in ("double", "float")
        self.short = name.split("::")[-1]
        self.key = f"{file}: {name}"

    def directions(self):
        return (("up", "* 10" if self.real else "* 2"), ("down", "/ 10" if self.real else "/ 2"))


class Declaration:
    """inline constexpr double a = 1, b = 2;"""

    def __init__(self, begin, end, type_, local, member, items):
        self.begin, self.end, self.type, self.local, self.member, self.items = begin, end, type_, local, member, items


def declarations(file, text, r):
    from mutation.source import line_of
    i = 0
    while i < len(r.t):
        if r.word(i) != "constexpr" or r.word(i - 1) == "if" or r.t[i].conditional:
            i += 1
            continue
        begin = i
        while r.word(begin - 1) in WORDS:
            begin -= 1
        k = i + 1
        while r.word(k) in WORDS:
            k += 1
        type_ = r.word(k)
        while r.word(k + 1) == "::":
            type_ += "::" + r.word(k + 2)
            k += 2
        k += 1
        i = k
        if type_ not in TYPES:
            continue
        scopes = [s for s in r.scopes if s[2] < begin < s[3]]
        innermost = max(scopes, key=lambda s: s[2]) if scopes else None
        local = in_function(r, begin, innermost)
        items = []
        while r.t[k].kind == "name" and r.word(k + 1) == "=" and r.word(k + 2) != "{":
            name, first = r.word(k), k + 2
            k = first
            while r.word(k) not in (",", ";"):
                k = r.partner[k] + 1 if r.word(k) in "([{" and k in r.partner else k + 1
            whole, line = "::".join(r.names_of(begin) + [name]), line_of(text, r.t[first - 2].begin)
            items.append(((name, first, k), Constant(file, line, whole, type_, local, r.written(first, k))))
            if r.word(k) == ";":
                break
            k += 1
        if items and r.word(k) == ";":
            member = innermost is not None and innermost[0] != "namespace" and not local
            yield Declaration(begin, k, type_, local, member, items)
            i = k


def in_function(r, i, innermost):
    """Whether a brace that opens no namespace and no class is around token i, within the innermost of these."""
    opens = {s[2] for s in r.scopes}
    start = innermost[2] + 1 if innermost else 0
    return any(r.word(k) == "{" and k not in opens and r.partner.get(k, 0) > i for k in range(start, i))


def worth(c):
    """A name or a cast of one, zero and the like have no mutants of their own. Negative integers are status values."""
    if re.fullmatch(r"[\w:]*[A-Za-z_][\w:]*", c.value) and not c.value[0].isdigit():
        return False
    try:
        return float(c.value) > 0 or (c.real and float(c.value) < 0)
    except ValueError:
        return bool(re.search(r"[0-9A-Za-z]", c.value))


def edit(r, d, dropped, numbers):
    """Text in place of the declaration without its semicolon, or None: nothing to change. numbers: {key: (slot, up, down)}.
    A declaration of constants without mutants, whose values are made of some with mutants, is constant no more."""
    short = {key.split("::")[-1].split(": ")[-1] for key in numbers}
    made = {c.key for _, c in d.items if c.key in dropped and short & set(re.findall(r"\w+", c.value))}
    kept = [c for _, c in d.items if c.key in dropped and c.key not in made]
    if len(kept) == len(d.items):
        return None
    head = "" if d.local else "static inline " if d.member else "inline " if r.word(d.begin) == "inline" else "static "
    out = []
    for (name, first, end), c in d.items:
        value = r.original(first, end)
        if c.key in made:
            out.append(f"{head}const {d.type}& {name} = {value}")
            continue
        if c.key in dropped:
            out.append(f"{head if not d.local else ''}constexpr {d.type} {name} = {value}")
            continue
        call = f"mutants::{'local' if d.local else 'value'}<{d.type}>({', '.join(map(str, numbers[c.key]))}, {value})"
        out.append(f"{head}const {d.type}{'' if d.local else '&'} {name} = {call}")
    return "; ".join(out)
