"""Runs of tests: without a mutant, to see what each test reaches; then each mutant against the tests that reach it."""
import concurrent.futures
import json
import os
import re
import resource
import subprocess
import tempfile
import threading

MEMORY = 8 << 30  # bytes a run may take: a count may be doubled into all there is


def limit():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


class Runner:
    def __init__(self, tree, programs, longest, jobs, log):
        self.tree, self.longest, self.jobs, self.log = tree, longest, jobs, log
        self.programs = programs
        self.lock = threading.Lock()
        self.base_file, self.results_file = tree.place / "base.json", tree.place / "results.json"
        self.base = json.loads(self.base_file.read_text()) if self.base_file.exists() else {}
        self.results = json.loads(self.results_file.read_text()) if self.results_file.exists() else {}
        self.kills = {}

    def save(self):
        with self.lock:
            for path, what in ((self.base_file, self.base), (self.results_file, self.results)):
                fresh = path.with_suffix(".new")
                fresh.write_text(json.dumps(what, indent=1))
                fresh.replace(path)

    def run(self, program, tests, timeout, **environment):
        """(status, output, seconds of the processor): status None when time is up."""
        command = [self.tree.out / "bin" / program, f"--gtest_filter={':'.join(tests)}", "--gtest_fail_fast", "--gtest_color=no"]
        env = {**os.environ, "LOCPATH": str(self.tree.out / "locale"), **environment}
        late = threading.Event()

        def end():
            late.set()
            os.killpg(process.pid, 9)

        with tempfile.TemporaryFile("w+", errors="replace") as output:
            process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, env=env, preexec_fn=limit,
                                       start_new_session=True, cwd=self.tree.tree)
            timer = threading.Timer(timeout, end)
            timer.start()
            _, status, usage = os.wait4(process.pid, 0)
            timer.cancel()
            process.returncode = os.waitstatus_to_exitcode(status)
            output.seek(0)
            return None if late.is_set() else process.returncode, output.read(), usage.ru_utime + usage.ru_stime

    # ------------------------------------------------------------------------------------------------ without a mutant
    def tests_of(self, program):
        command = [self.tree.out / "bin" / program, "--gtest_list_tests", "--gtest_filter=-*Slow*"]
        listed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        suite = ""
        for line in listed.split("\n"):
            name = line.split("#")[0].rstrip()
            if name and not name.startswith(" ") and name.endswith("."):
                suite = name
            elif name.startswith("  "):
                yield suite + name.strip()

    def measure(self, layout):
        """Each test once, alone. layout: what the numbers of what is reached mean; another one needs all runs anew."""
        if self.base.get("layout") != layout:
            self.base = {"layout": layout, "tests": {}}
        longest = 3 * self.longest
        again = {k for k, v in self.base["tests"].items() if v.get("longer_than", longest) < longest}
        todo = [(p, t) for p in self.programs for t in self.tests_of(p) if f"{p} {t}" not in self.base["tests"].keys() - again]
        present = {f"{p} {t}" for p in self.programs for t in self.tests_of(p)}
        self.base["tests"] = {k: v for k, v in self.base["tests"].items() if k in present or k.split()[0] not in self.programs}
        self.log(f"{len(todo)} tests to be run without a mutant")

        def one(item):
            program, test = item
            record = self.tree.place / f"record.{threading.get_ident()}"
            record.unlink(missing_ok=True)
            status, _, took = self.run(program, [test], 4 * longest, DYN_MUTANTS_RECORD=str(record))
            if status:  # recording itself may be what fails
                status, _, took = self.run(program, [test], 4 * longest)
            reached = sorted(set(record.read_text().split())) if record.exists() else []
            with self.lock:
                found = {"ok": status == 0, "seconds": round(took, 3), "reached": reached}
                self.base["tests"][f"{program} {test}"] = found
                if status is None:
                    found["longer_than"] = longest
            if status != 0:
                self.log(f"{'takes too long' if status is None else 'fails'} without a mutant, left out: {program} {test}")

        self.each(one, todo)
        self.save()

    def each(self, one, items):
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            for done in concurrent.futures.as_completed([pool.submit(one, i) for i in items]):
                done.result()

    # ------------------------------------------------------------------------------------------------ with one
    def reaching(self, mutant, slots):
        """Names of the tests that reach a mutant, what is short first."""
        if mutant.kind == "expression":
            marks = {f"e{self.number[mutant.key]}"}
        else:
            keys = {mutant.key}
            while True:  # constants whose values are made of it
                short = {k.split(": ")[1].split("::")[-1] for k in keys}
                made = {k for k, c in self.tree.constants.items() if k in slots and short & set(re.findall(r"\w+", c.value))}
                more = made | keys
                if more == keys:
                    break
                keys = more
            marks = {f"c{slots[k][0]}" for k in keys}
        tests = [(v["seconds"] / (1 + self.kills.get(k, 0)), k) for k, v in self.base["tests"].items()
                 if v["ok"] and v["seconds"] <= self.longest and k.split()[0] in self.programs and marks & set(v["reached"])]
        return [k for _, k in sorted(tests)]

    def chunks(self, tests):
        """Tests of one program that take half a second together, in the order of their length."""
        open_ = {}
        for test in tests:
            program, name = test.split(" ", 1)
            seconds = self.base["tests"][test]["seconds"]
            group = open_.setdefault(program, [[], 0.0])
            if group[0] and (group[1] + seconds > 0.5 or len(group[0]) >= 60):
                yield program, group[0], group[1]
                group = open_[program] = [[], 0.0]
            group[0].append(name)
            group[1] += seconds
        for program, (names, seconds) in open_.items():
            yield program, names, seconds

    def kill(self, number, key, mutant):
        known = self.results.get(key, {})
        if known.get("killed"):
            return
        tried = set(known.get("tried", []))
        tests = [t for t in self.reaching(mutant, self.tree.slots) if t not in tried]
        killed = None
        for program, names, seconds in self.chunks(tests):
            status, output, _ = self.run(program, names, 10 * seconds + 10, DYN_MUTANT=str(number))
            if status != 0:
                failed = re.findall(r"\[  FAILED  \] (\S+?)(?:,| \(|$)", output, re.M)
                begun = re.findall(r"\[ RUN      \] (\S+)", output)
                how = "failed" if failed else "took too long" if status is None else f"ended by {status}"
                killed = f"{program} {(failed[:1] or begun[-1:] or ['?'])[0]}", how
                break
            tried |= {f"{program} {n}" for n in names}
        with self.lock:
            if killed:
                self.kills[killed[0]] = self.kills.get(killed[0], 0) + 1
                self.results[key] = {"killed": killed[0], "how": killed[1]}
            else:
                self.results[key] = {"killed": None, "tried": sorted(tried)}
        if killed or tests:
            self.log(f"{key}: {'killed by ' + killed[0] if killed else 'SURVIVED ' + str(len(tried)) + ' tests'}")
        self.save()

    def all(self, only="", excused=()):
        """Every mutant whose key has `only` against its tests. excused: keys that no run is spent on."""
        self.number = {m.key: n for n, (m, d) in self.tree.numbered.items() if d is None}
        for v in self.results.values():
            if v.get("killed"):
                self.kills[v["killed"]] = self.kills.get(v["killed"], 0) + 1
        items = [(n, m.key if d is None else f"{m.key} {d}", m) for n, (m, d) in self.tree.numbered.items()]
        self.each(lambda i: self.kill(*i), [i for i in items if i[1] not in excused and re.search(only, i[1])])
        self.save()
