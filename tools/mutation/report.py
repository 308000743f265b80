"""Results as a table, and the list of mutants that need no test."""


def listed(path):
    """(mutants that are added, {key: reason} of those that need no test) of tests/mutants.txt."""
    found, added = {}, []
    if path.exists():
        for line in path.read_text().split("\n"):
            if line.startswith("add "):
                added.append(tuple(line[4:].split(" | ")))
            elif line.strip() and not line.startswith("#"):
                key, reason = line.rsplit(" | ", 1)
                found[key.strip()] = reason.strip()
                if not key.strip().endswith((" up", " down")):
                    found[key.strip() + " up"] = found[key.strip() + " down"] = reason.strip()
    return added, found


def rows(tree, runner, excuses):
    out = []
    for number, (m, direction) in tree.numbered.items():
        key = m.key if direction is None else f"{m.key} {direction}"
        result = runner.results.get(key, {})
        if key in excuses and not result.get("killed"):
            verdict, by = "excused", excuses[key]
        elif result.get("killed"):
            verdict, by = "killed", result["killed"] + ("" if result["how"] == "failed" else f" ({result['how']})")
        elif result:
            verdict, by = "SURVIVED", f"{len(result['tried'])} tests"
        else:
            verdict, by = "not run", ""
        what = m.text if direction is None else f"{m.name.removeprefix('dyn::')} = {m.value} {dict(m.directions())[direction]}"
        out.append({"number": number, "file": m.file, "line": m.line, "kind": m.kind, "key": key, "mutation": what,
                    "verdict": verdict, "by": by})
    return out


def table(rows):
    return "\n".join(f"{r['number']:4} {r['verdict']:8} {r['file']}:{r['line']}: {r['mutation']}: {r['by']}" for r in rows)


def constants_of(rows):
    """{constant: verdicts of its two mutants}"""
    found = {}
    for r in rows:
        if r["kind"] == "constant":
            found.setdefault(r["key"].rsplit(" ", 1)[0], []).append(r["verdict"])
    return found


def counts(rows, folder, kind):
    mine = [r for r in rows if r["file"].startswith(folder + "/") and r["kind"] == kind]
    return [sum(r["verdict"] == v for r in mine) for v in ("killed", "excused", "SURVIVED", "not run")]


def folders_of(rows, kind):
    return list(dict.fromkeys("/".join(r["file"].split("/")[:2]) for r in rows if r["kind"] == kind))


def summary(tree, rows):
    lines = []
    found = constants_of(rows)
    if found:
        noticed = sum("killed" in v for v in found.values())
        lines.append(f"tests notice {noticed} of {len(found)} constants ({tree.found_constants - len(found)} more have to be "
                     "constant)")
    for kind in ("constant", "expression"):
        for folder in folders_of(rows, kind):
            killed, excuse, survived, left = counts(rows, folder, kind)
            lines.append(f"{folder}: {killed} of {killed + excuse + survived} mutants of {kind}s killed, {excuse} excused, "
                         f"{survived} survived, {left} not run")
    return "\n".join(lines)


def page(rows):
    """The table of capi/pages/measured_mutants.md."""
    out = ["| folder | changes | mutants | killed | excused | survived | not run |", "|---|---|---|---|---|---|---|"]
    for kind in ("constant", "expression"):
        for folder in folders_of(rows, kind):
            all_ = counts(rows, folder, kind)
            out.append(f"| {folder} | {kind}s | {sum(all_)} | " + " | ".join(map(str, all_)) + " |")
    found = constants_of(rows)
    noticed = sum("killed" in v for v in found.values())
    open_ = [k.split("dyn::")[1] for k, v in found.items() if "killed" not in v and "SURVIVED" in v]
    rest = "No test notices these:" if open_ else "The others are excused."
    out += ["", f"Tests notice {noticed} of {len(found)} constants. {rest}", ""]
    out += [f"- `{k}`" for k in open_]
    return "\n".join(out).rstrip()
