#!/usr/bin/env python3
"""Holds the form of the documents: columns of dyn.h, size of README.md, mean length of sentences. Prints the means.
Names of one author's own, of which the field has another, come up nowhere.

words.py ROOT
"""

import re
import sys
from pathlib import Path

COLUMNS = 110  # of include/dyn.h
BYTES = 8192  # of README.md
MEAN = 16  # words in a sentence, the mean of a file
SHORTEST = 4  # words; shorter pieces are labels and would flatter the mean
PRIVATE = {  # names: the field's
    r"LooseSet|LooseColumns|begin_flight|\bfly\(|\bland\(": "FreeBodies, integrate_velocity, integrate_position",
    r"HeldWeight|held_weights": "GravityCompensation",
    r"held_dynamics|HeldWrench|hold_errors|hold_velocity|close_rows":
        "constrained_forward_dynamics, AppliedWrench, project_velocity, project_to_constraints",
    r"\bSlotBlock\b|\bstruct Slot\b": "ConstraintInstance",
    r"\b[Pp]olish(ed)?\b": "Newton refinement",
    r"\bSumPair\b|\bsums\.hpp": "minkowski_segments",
    r"\b[Cc]ull(ed|ing)?\b": "bounding spheres",
    r"\bSecondAnswer\b|\bsecond\.hpp": "fallback_narrowphase",
    r"\bSweeper\b|sweep_to_rest": "block Gauss-Seidel",
    r"\ball_clear\b|note_clearance": "conservative advancement",
    r"\bpeer_joint\b": "state_layout",
    r"\bSweepD\b|\bFloat8\b|\bVec3::Lanes\b": "Simd<T, N>",
    r"\b\w+_room\b": "capacity",
    r"\bmoderate\(": "no_overflow",
    r"\btake_back\b": "rollback",
    r"\bAnswers\b": "Returns",
    r"\bthe doctor\b": "constraint diagnostics",
}
SOURCES = ("src", "include", "capi", "tests", "tools", "bench", ".github", "README.md")
SUFFIXES = (".hpp", ".cpp", ".h", ".c", ".def", ".py", ".js", ".sh", ".md", ".cmake", ".txt")


def private_names(root):
    """Faults: places in the sources that have a private name, this list aside."""
    for top in SOURCES:
        for path in sorted((root / top).rglob("*")) or [root / top]:
            if path.suffix not in SUFFIXES or path == Path(__file__).resolve():
                continue
            text = path.read_text(encoding="utf-8", errors="replace")
            for pattern, known in PRIVATE.items():
                for found in re.finditer(pattern, text):
                    line = text.count("\n", 0, found.start()) + 1
                    yield f"{path}:{line}: '{found.group()}' is a private name: write {known}"


def sentence_lengths(paragraphs):
    """Words of each sentence. A sentence ends with its paragraph, or at . ? ! before a blank. A word has a letter."""
    pieces = (s for p in paragraphs for s in re.split(r"(?<=[.?!])[)\"*_]*\s+", p))
    counts = (sum(bool(re.search(r"[A-Za-z]", w)) for w in s.split()) for s in pieces)
    return [n for n in counts if n >= SHORTEST]


def comment_paragraphs(text):
    """Paragraphs of a C header's comments. A line indented by five or more begins an entry, deeper lines continue it."""
    paragraphs = []
    for comment in re.findall(r"/\*(?! -)(.*?)\*/", text, re.S):
        lines = comment.strip().split("\n")
        stars = len(lines) > 1 and all(line.startswith(" *") for line in lines[1:])
        paragraph, entry = lines[0], 0  # entry: the indent of the current entry, 0 outside of entries
        for line in (line[2:] + " " if stars else line for line in lines[1:]):
            indent = len(line) - len(line.lstrip())
            begins = indent <= entry if entry else indent >= 5 or stars and re.match(r" {3}\S+( \S+)* {2}", line)
            if not line.strip() or begins or entry and indent < entry:
                paragraphs.append(paragraph)
                paragraph, entry = "", indent if line.strip() and begins and indent >= 3 else 0
            paragraph += " " + line.strip()
        paragraphs.append(paragraph)
    return [p for p in paragraphs if not re.search(r"^\s*[\w^' .|(]+ <?= ", p)]  # formulas


def page_paragraphs(text):
    """Paragraphs of a page, without code, tables, headings, comments and details. A link is its text, a piece of code one
    word."""
    text = re.sub(r"^ *```.*?^ *```", "", text, flags=re.S | re.M)
    text = re.sub(r"<!--.*?-->|<details>.*?</details>", "", text, flags=re.S)  # details hold what programs printed
    text = re.sub(r"^(#| *\|).*$", "", text, flags=re.M)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"`[^`]*`", "code", text)
    return re.split(r"\n\s*\n|\n(?= *(?:[-*]|\d+\.) )", text)


def main(root):
    dyn_h, readme = root / "include/dyn.h", root / "README.md"
    faults = [f"{dyn_h}:{n}: {len(line)} columns, at most {COLUMNS}"
              for n, line in enumerate(dyn_h.read_text().splitlines(), 1) if len(line) > COLUMNS]
    size = len(readme.read_bytes())
    if size > BYTES:
        faults.append(f"{readme}: {size} bytes, at most {BYTES}: move a topic to capi/pages")
    print("mean words a sentence (sentences):")
    for path in (dyn_h, readme, *sorted((root / "capi/pages").glob("*.md"))):
        text = path.read_text()
        lengths = sentence_lengths(comment_paragraphs(text) if path == dyn_h else page_paragraphs(text))
        mean = sum(lengths) / max(len(lengths), 1)
        print(f"  {mean:5.1f} ({len(lengths):4}) {path.relative_to(root)}")
        if mean > MEAN:
            faults.append(f"{path}: {mean:.1f} words a sentence, at most {MEAN}: state one fact a sentence")
    faults += private_names(root.resolve())
    print(*faults, sep="\n", file=sys.stderr)
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
