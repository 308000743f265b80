"""The mutated tree and its one build."""
import concurrent.futures
import json
import os
import re
import subprocess
from pathlib import Path

from mutation import constants, expressions
from mutation.source import Reader, line_of

HERE = Path(__file__).resolve().parent
SOURCES = (".hpp", ".cpp")
COPIED = ("CMakeLists.txt", "LICENSE", "README.md", "bench", "capi", "include", "models", "src", "tests", "tools")


def write(path, text):
    """Keeps the time of a file that stays."""
    if not path.exists() or path.read_bytes() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text)


class Tree:
    def __init__(self, root, place, folders_constants, folders_expressions, added, seed, count):
        """added: (file, old, new) of further mutants."""
        self.root, self.place, self.tree, self.out = root, place, place / "tree", place / "build"
        self.count = count
        self.readers, self.declared, self.constants = {}, {}, {}
        self.other_names = {}  # name of a constant without mutants: the words of its value
        self.candidates = {}  # folder: mutants in order of choice
        self.dropped = {}     # key: reason
        drop_file = place / "dropped.json"
        if drop_file.exists():
            self.dropped = json.loads(drop_file.read_text())
        for folder in folders_constants:
            for file, text, r in self.sources(folder):
                found = list(constants.declarations(file, text, r))
                self.declared[file] = found
                for d in found:
                    for _, c in d.items:
                        if constants.worth(c):
                            self.constants[c.key] = c
                        else:
                            self.other_names.setdefault(c.short, set()).update(re.findall(r"[A-Za-z_]\w*", c.value))
        for folder in folders_expressions:
            every = [m for file, text, r in self.sources(folder) for m in expressions.found(file, text, r)]
            self.candidates[folder] = expressions.chosen(every, seed, count * 2)
        self.added = [expressions.added(file, *self.source(file), old, new) for file, old, new in added]
        self.found_constants = len(self.constants)

    def sources(self, folder):
        for path in sorted((self.root / folder).rglob("*")):
            if path.suffix in SOURCES:
                file = str(path.relative_to(self.root))
                yield (file, *self.source(file))

    def source(self, file):
        if file not in self.readers:
            text = (self.root / file).read_text()
            self.readers[file] = text, Reader(text)
        return self.readers[file]

    def drop(self, key, reason):
        if key in self.dropped:
            return False
        self.dropped[key] = reason
        (self.place / "dropped.json").write_text(json.dumps(self.dropped, indent=1))
        return True

    def mutants(self):
        """{number: (mutant, direction)}, expressions first; constants' slots."""
        kept = [m for m in self.added if m.key not in self.dropped]
        taken = {(m.file, m.part.begin) for m in kept}
        for every in self.candidates.values():
            kept += [m for m in every if m.key not in self.dropped and (m.file, m.part.begin) not in taken][:self.count]
        numbered = {i + 1: (m, None) for i, m in enumerate(kept)}
        slots = {}
        for slot, c in enumerate((c for c in self.constants.values() if c.key not in self.dropped), 1):
            first = len(numbered) + 1
            slots[c.key] = slot, first, first + 1
            for n, (direction, _) in enumerate(c.directions()):
                numbered[first + n] = c, direction
        return numbered, len(kept), slots

    def sync(self):
        """Copies the tree; the chosen sources are written with their mutants."""
        self.numbered, self.expressions, self.slots = self.mutants()
        edits, parts = {}, {}
        for number, (m, _) in self.numbered.items():
            if m.kind == "expression":
                parts.setdefault((m.file, m.part.begin), []).append((number, m))
        for (file, _), mutants in parts.items():
            r, part = self.readers[file][1], mutants[0][1].part
            text, beyond = expressions.edit(r, part, mutants)
            edits.setdefault(file, []).append((r.t[part.begin].begin, r.t[part.end - 1 + beyond].end, text))
        for file, found in self.declared.items():
            r = self.readers[file][1]
            for d in found:
                out = {c.key for _, c in d.items if c.key not in self.slots}
                text = constants.edit(r, d, out, self.slots)
                if text:
                    edits.setdefault(file, []).append((r.t[d.begin].begin, r.t[d.end].begin, text))
        listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", *COPIED], cwd=self.root, check=True,
                                capture_output=True, text=True).stdout.split("\n")
        listed = {f for f in listed if f and (self.root / f).is_file()}
        for file in listed:
            if file in edits:
                text = self.readers[file][0]
                for begin, end, new in sorted(edits[file], reverse=True):
                    lines = text.count("\n", begin, end) - new.count("\n")
                    text = text[:begin] + new + "\n" * lines + text[end:]
                write(self.tree / file, f'#include "mutants.hpp"\n#line 1 "{self.tree / file}"\n{text}'.encode())
            else:
                write(self.tree / file, (self.root / file).read_bytes())
                if os.access(self.root / file, os.X_OK):
                    (self.tree / file).chmod(0o755)
        for path in self.tree.rglob("*"):
            if path.is_file() and str(path.relative_to(self.tree)) not in listed and path.name != "mutants.hpp":
                path.unlink()
        header = (HERE / "mutants.hpp").read_text().replace("MUTANTS_EXPRESSIONS", str(self.expressions))
        write(self.tree / "src/mutants.hpp", header.replace("MUTANTS_CONSTANTS", str(len(self.slots))).encode())

    # ------------------------------------------------------------------------------------------------ compiling
    def configure(self):
        # the compiler decides what is in line, which takes a third of the time
        made = subprocess.run(["cmake", "-S", self.tree, "-B", self.out, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                               "-DCMAKE_CXX_FLAGS=-DDYN_SMALL=1", "-DCMAKE_CXX_FLAGS_RELEASE=-O2 -DNDEBUG", "-DDYN_ARCH=native",
                               "-DDYN_LEVELS=OFF", "-DDYN_TOGETHER=ON", "-DDYN_WERROR=OFF", "-DDYN_TESTS=ON",
                               "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON"], capture_output=True, text=True)
        if made.returncode:
            raise SystemExit(f"tools/mutants: cmake failed\n{made.stderr}")

    def compile(self, programs, jobs, log):
        """Builds; what does not compile is dropped, until all compiles. First a look at the sources alone, which takes less."""
        self.sync()
        self.configure()
        subprocess.run(["ninja", "-C", self.out, "dyn_tables"], check=True, capture_output=True)
        looked = self.place / "looked_at.json"
        sources = [] if looked.exists() and looked.read_text() == self.names() else self.core_sources()
        while sources:
            with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
                done = list(zip(sources, pool.map(self.check, sources)))
            errors = "".join(text for _, (ok, text) in done if not ok)
            sources = [s for s, (ok, _) in done if not ok]
            log(f"{len(done)} sources looked at, {len(sources)} with errors")
            if sources:
                self.drop_by(errors, log)
                self.sync()
        looked.write_text(self.names())
        while True:
            built = subprocess.run(["ninja", "-C", self.out, "-k", "0", f"-j{jobs}", "bin/dyn", *(f"bin/{p}" for p in programs)],
                                   capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
            if built.returncode == 0:
                return
            self.drop_by(built.stdout, log)
            self.sync()

    def names(self):
        return json.dumps([m.key for m, _ in self.numbered.values()])

    def core_sources(self):
        commands = json.loads((self.out / "compile_commands.json").read_text())
        changed = {str(self.tree / f) for f in self.readers}
        folders = {str(Path(f).parent) for f in changed}
        out, seen = [], set()
        for c in commands:
            is_one = str(Path(c["file"]).parent) in folders or "dyn_host" in c["file"] and "unity" in c["file"]
            if is_one and c["file"] not in seen:
                seen.add(c["file"])
                command = re.sub(r" -o \S+", "", c["command"]).replace("/usr/bin/ccache ", "")
                out.append((c["directory"], command + " -fsyntax-only -w"))
        return out

    @staticmethod
    def check(source):
        env = {**os.environ, "LC_ALL": "C"}
        run = subprocess.run(source[1], shell=True, cwd=source[0], capture_output=True, text=True, env=env)
        return run.returncode == 0, run.stderr

    def drop_by(self, errors, log):
        """Drops what the compiler's errors name: a constant by its name, an expression by its lines."""
        dropped, unknown, tree = set(), [], str(self.tree) + "/"
        names = {}
        for c in self.constants.values():
            names.setdefault(c.short, []).append(c)
        lines = {}
        for m, _ in self.numbered.values():
            if m.kind == "expression":
                text, r = self.readers[m.file]
                first, last = line_of(text, r.t[m.part.begin].begin), line_of(text, r.t[m.part.end - 1].begin)
                for line in range(first, last + 1):
                    lines.setdefault((m.file, line), []).append(m)
        for diagnostic in re.split(r"(?m)^(?=\S+:\d+:\d+: error)", errors)[1:]:
            place = re.match(r"(\S+?):(\d+):\d+: error: (.*)", diagnostic)
            quoted = re.findall(r"'([^']*)'", "\n".join(s for s in diagnostic.split("\n") if "error:" in s or "note:" in s))
            hit = False
            for name in quoted:
                name = re.sub(r"\(anonymous namespace\)::|\{anonymous\}::|<[^<>]*>", "", name).split(" ")[-1]
                for c in names.get(name.split("::")[-1], []):
                    if "::" not in name or c.name.endswith(name) or name.endswith(c.name):
                        hit = True
                        if self.drop(c.key, "has to be constant"):
                            dropped.add(c.key)
            for file, line in re.findall(r"(?m)^(\S+?):(\d+):\d+:", diagnostic):
                file = file.replace(tree, "")
                for m in lines.get((file, int(line)), []):
                    hit = True
                    if self.drop(m.key, f"does not compile: {place[3]}"):
                        dropped.add(m.key)
            if not hit:
                unknown.append(place)
        for place in unknown if not dropped else ():  # other errors may be why
            file, line = place[1].replace(tree, ""), int(place[2])
            for word in re.findall(r"\w+", self.readers[file][0].split("\n")[line - 1]) if file in self.readers else ():
                for c in (c for w in {word} | self.other_names.get(word, set()) for c in names.get(w, [])):
                    if c.key in self.slots and self.drop(c.key, f"does not compile: {place[3]}"):
                        dropped.add(c.key)
        log(f"dropped {len(dropped)}: {', '.join(sorted(dropped))[:2000]}")
        if not dropped:
            raise SystemExit(f"tools/mutants: errors that no mutant explains\n{errors[:6000]}")
