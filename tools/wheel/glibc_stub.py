"""Writes assembly and version script of a library that stands in for one of glibc when programs are linked: the same names,
without what came after a version.   glibc_stub.py LIBRARY VERSION OUT    (OUT.s, OUT.map)"""

import re
import subprocess
import sys

library, newest, out = sys.argv[1:]


def number(version):
    return tuple(int(x) for x in version.removeprefix("GLIBC_").split("."))


symbols = {}  # name: [(version, is default, type, size)]
table = subprocess.run(["readelf", "--dyn-syms", "--wide", library], check=True, capture_output=True, text=True).stdout
for line in table.splitlines():
    words = line.split()
    if len(words) < 8 or words[6] == "UND" or not (found := re.fullmatch(r"(.+?)(@@?)(GLIBC_[\d.]+)", words[7])):
        continue
    name, at, version = found.groups()
    symbols.setdefault(name, []).append((version, at == "@@", words[3], int(words[2], 0)))

lines, versions = [], set()
for name, all_versions in sorted(symbols.items()):
    kept = sorted((s for s in all_versions if number(s[0]) <= number(newest)), key=lambda s: number(s[0]))
    was_default = any(s[1] for s in all_versions)
    for k, (version, _, kind, size) in enumerate(kept):
        at = "@@" if was_default and k + 1 == len(kept) else "@"
        stub = f"stub{len(versions)}_{len(lines)}"
        section = {"OBJECT": ".bss", "TLS": ".section .tbss,\"awT\",%nobits"}.get(kind, ".text")
        elf_type = {"OBJECT": "object", "TLS": "tls_object"}.get(kind, "function")
        bytes_ = max(size, 1) if section != ".text" else 1
        lines.append(f"{section}\n.globl {stub}\n.type {stub}, %{elf_type}\n.size {stub}, {size}\n{stub}: .skip {bytes_}\n"
                     f".symver {stub}, {name}{at}{version}, remove\n")
        versions.add(version)
with open(out + ".s", "w", encoding="ascii") as file:
    file.writelines(lines)
    file.write('.section .note.GNU-stack,"",%progbits\n')
with open(out + ".map", "w", encoding="ascii") as file:
    for k, version in enumerate(sorted(versions, key=number)):
        file.write(f"{version} {{{' local: stub*;' if k == 0 else ''} }};\n")
