"""C++ sources as tokens, and the statements among them: just enough of the language to change one operator."""
import re
from dataclasses import dataclass

TOKEN = re.compile(r"""
    (?P<comment>//[^\n]*|/\*.*?\*/)
  | (?P<directive>(?<![^\n])[ \t]*\#(?:\\\n|[^\n])*)
  | (?P<string>R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])*')
  | (?P<number>\.?[0-9](?:[eEpP][+-]|['.\w])*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<sign><=>|<<=|>>=|->\*|\.\.\.|::|->|\+\+|--|<<|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|[^\s\w])
  """, re.X | re.S)
OTHER = set("alignas asm break catch class constexpr continue enum extern friend goto static static_assert struct template throw "
            "typedef union using".split())
OPEN, CLOSE = {"(": ")", "[": "]", "{": "}"}, set(")]}")


@dataclass
class Token:
    kind: str
    text: str
    begin: int
    end: int
    conditional: bool  # between #if and #endif


def tokens(text):
    found, depth = [], 0
    for match in TOKEN.finditer(text):
        kind, word = match.lastgroup, match.group()
        if kind == "directive":
            head = word.strip().lstrip("#").strip()
            depth += head.startswith("if") - head.startswith("endif")
        elif kind != "comment":
            found.append(Token(kind, word, match.start(), match.end(), depth > 0))
    return found


def line_of(text, position):
    return text.count("\n", 0, position) + 1


@dataclass
class Part:
    """Tokens [begin, end) that may be written twice. kind: condition, result, value (of a declaration), statement."""
    kind: str
    begin: int
    end: int


class Reader:
    """The parts of the function bodies of a source, and where its namespaces and classes begin and end."""

    def __init__(self, text):
        self.text, self.t = text, tokens(text)
        self.parts, self.scopes, self.partner = [], [], {}
        stack = []
        for i, token in enumerate(self.t):
            if token.text in OPEN and token.kind == "sign":
                stack.append(i)
            elif token.text in CLOSE and token.kind == "sign" and stack:
                self.partner[stack.pop()] = i
        self.declarations(0, len(self.t))

    def word(self, i):
        return self.t[i].text if 0 <= i < len(self.t) else ""

    # ------------------------------------------------------------------------------------------------ outside of functions
    def declarations(self, i, end):
        head = i
        while i < end:
            word = self.word(i)
            if word == "{":
                close = self.partner.get(i, end)
                words = [t.text for t in self.t[head:i]]
                if "namespace" in words or "extern" in words and self.word(i - 1) == '"C"':
                    self.scope(words, "namespace", i, close)
                elif self.is_code(i, words):
                    self.block(i + 1, close)
                elif {"class", "struct", "union"} & set(words) and "=" not in words and "enum" not in words:
                    self.scope(words, next(w for w in words if w in ("class", "struct", "union")), i, close)
                    i = close + 1
                    continue  # a declarator may follow
                i = close + 1
                if self.word(i) != "{" and self.word(i) != ";" and self.word(i) != ",":
                    head = i
                continue
            if word in "([" and i in self.partner:
                i = self.partner[i] + 1
                continue
            i += 1
            if word == ";" or word == ":" and self.word(i - 2) in ("public", "private", "protected"):
                head = i

    def scope(self, words, key, i, close):
        at = len(words) - 1 - words[::-1].index(key)
        name = []
        for word in words[at + 1:]:
            if re.fullmatch(r"[A-Za-z_]\w*", word):
                if word not in ("alignas", "final"):
                    name.append(word)
                    if key != "namespace":
                        break
            elif word != "::":
                break
        self.scopes.append((key, name, i, close))
        self.declarations(i + 1, close)

    def is_code(self, i, words):
        last = self.word(i - 1)
        if last in (")", "const", "noexcept", "override", "mutable", "try", "else", "do", "]"):
            return True
        if last == "}":
            return ")" in words
        return "->" in words and ")" in words

    # ------------------------------------------------------------------------------------------------ in functions
    def block(self, i, end):
        while i < end:
            i = self.statement(i, end)

    def head(self, i):
        """The parenthesis at or behind i (if constexpr): its begin and end."""
        while self.word(i) != "(":
            i += 1
        return i, self.partner[i]

    def statement(self, i, end):
        word = self.word(i)
        if word == "{":
            close = self.partner[i]
            self.block(i + 1, close)
            return close + 1
        if word in ("if", "while", "switch"):
            constant = self.word(i + 1) == "constexpr"
            open_, close = self.head(i)
            begin = self.after_semicolon(open_ + 1, close)
            assigns = "=" in map(self.word, range(begin, close))
            if word != "switch" and not constant and not (assigns and self.declares(begin, close)):
                self.part("condition", begin, close)
            i = self.statement(close + 1, end)
            if word == "if" and self.word(i) == "else":
                i = self.statement(i + 1, end)
            return i
        if word == "for":
            open_, close = self.head(i)
            first = self.after_semicolon(open_ + 1, close)
            if first > open_ + 1:
                self.part("condition", first, self.after_semicolon(first, close) - 1)
            return self.statement(close + 1, end)
        if word == "do":
            i = self.statement(i + 1, end)
            open_, close = self.head(i)
            self.part("condition", open_ + 1, close)
            return close + 2
        if word == "else" or word == "try":
            return i + 1
        if word in ("case", "default"):
            while self.word(i) != ":":
                i += 1
            return i + 1
        if word == "return":
            stop, code = self.until_semicolon(i + 1, end)
            if not code and stop > i + 1 and self.word(i + 1) != "{":
                self.part("result", i + 1, stop)
            return stop + 1
        stop, code = self.until_semicolon(i, end)
        if word in OTHER:
            return stop + 1
        if self.declares(i, stop):
            for begin, last in self.values(i, stop):
                self.part("value", begin, last)
        elif not code and stop > i:
            self.part("statement", i, stop)
        return stop + 1

    def part(self, kind, begin, end):
        if begin < end and not any(self.is_lambda(k) for k in range(begin, end) if self.word(k) == "{"):
            self.parts.append(Part(kind, begin, end))

    def is_lambda(self, i):
        typed = self.t[i - 1].kind == "name" and self.word(i - 2) == "->" and self.word(i - 3) == ")"
        return typed or self.word(i - 1) in (")", "mutable", "noexcept", "]")

    def after_semicolon(self, i, end):
        """Behind the first semicolon of [i, end), or i."""
        k = i
        while k < end:
            if self.word(k) == ";":
                return k + 1
            k = self.partner[k] + 1 if self.word(k) in OPEN else k + 1
        return i

    def until_semicolon(self, i, end):
        """The semicolon that ends the statement, and whether code is in it, which is read on the way."""
        code = False
        while i < end and self.word(i) != ";":
            if self.word(i) == "{" and self.is_lambda(i):
                code = True
                self.block(i + 1, self.partner[i])
                i = self.partner[i] + 1
            else:
                i += 1
        return i, code

    def declares(self, i, end):
        """Whether tokens [i, end) declare a variable: type name, in front of = ( { or nothing."""
        k, last = i, []
        while k < end and self.word(k) not in ("=", "(", "{", "+=", "-=", "*=", "/=", ";"):
            if self.word(k) == "[" and last and last[-1] != "auto" and last[-1] != "&":
                k = self.partner[k]
            elif self.word(k) == "[":
                return bool(last) and last[-1] in ("auto", "&")
            last.append(self.word(k))
            k += 1
        names = [w for w in last if w != "["]
        if len(names) < 2 or not re.fullmatch(r"[A-Za-z_]\w*", names[-1]):
            return False
        return bool(re.fullmatch(r"[A-Za-z_]\w*|>|&|\*|&&", names[-2])) and bool(re.match(r"[A-Za-z_]", names[0]))

    def values(self, i, end):
        """Each initial value of a declaration that follows a =."""
        k = i
        while k < end:
            if self.word(k) == "=":
                begin = k = k + 1
                while k < end and self.word(k) != ",":
                    k = self.partner[k] + 1 if self.word(k) in OPEN else k + 1
                if self.word(begin) != "{":
                    yield begin, k
            else:
                k = self.partner[k] + 1 if self.word(k) in OPEN else k + 1

    def names_of(self, i):
        """Namespaces and classes around token i."""
        return [name for _, names, begin, end in self.scopes if begin < i < end for name in names]

    def written(self, begin, end, change=None):
        """Tokens [begin, end) on one line, without comments. change: {token: text}."""
        out, at = [], None
        for i in range(begin, end):
            token = self.t[i]
            if at is not None and token.begin > at:
                out.append(" ")
            out.append((change or {}).get(i, token.text))
            at = token.end
        return "".join(out)

    def original(self, begin, end):
        return self.text[self.t[begin].begin:self.t[end - 1].end]
