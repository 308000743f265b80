"""The man page and the completions of shells: what `dyn manual` prints has every subcommand and option, and is well formed."""

import re
import shutil
import subprocess

import pytest
from command import CLI, run

pytestmark = pytest.mark.skipif(not CLI, reason="the command dyn is not built")


def subcommands():
    return re.findall(r"^  (\w+) ", run("--help").split("Subcommands:")[1], re.M)


def options(command):
    return set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", run(command, "--help"), re.M))


@pytest.mark.parametrize("form", ["man", "bash", "zsh", "fish"])
def test_every_option_is_there(form):
    text = run("manual", form).replace("\\-", "-")
    for command in subcommands():
        assert re.search(rf"\b{command}\b", text)
        for option in options(command):
            name = f"-l {option[2:]}" if form == "fish" else option
            assert re.search(rf"{re.escape(name)}(?![\w-])", text), (command, option)
    assert "manual" not in subcommands()


def test_the_man_page_is_well_formed(tmp_path):
    if not shutil.which("man"):
        pytest.skip("man is not installed")
    page = tmp_path / "dyn.1"
    page.write_text(run("manual", "man"))
    done = subprocess.run(["man", "--warnings", "-l", str(page)], capture_output=True, text=True,
                          env={"PATH": "/usr/bin:/bin", "MANWIDTH": "120", "LC_ALL": "C.UTF-8"})
    assert done.returncode == 0 and done.stderr == ""
    assert "--contact-capacity INT" in done.stdout and "EXIT STATUS" in done.stdout


def completed(words, now):
    """What bash proposes for the word after these."""
    line = " ".join(f"'{w}'" for w in [*words, now])
    program = f"{run('manual', 'bash')}\nCOMP_WORDS=({line}); COMP_CWORD={len(words)}; _dyn; printf '%s\\n' \"${{COMPREPLY[@]}}\""
    done = subprocess.run(["bash", "-c", program], capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == ""
    return done.stdout.split()


def test_bash_completes():
    assert set(completed(["dyn"], "")) >= {"info", "sim", "stress", "--version"}
    assert completed(["dyn"], "acc") == ["accuracy"]
    assert set(completed(["dyn", "sim", "robot.urdf"], "--fl")) == {"--floating"}
    assert set(completed(["dyn", "info", "--collision-meshes"], "")) == {"none", "hull", "triangles", "auto"}
    assert "rk4" in completed(["dyn", "sim", "--integrator"], "")
    assert completed(["dyn", "eval", "--compute"], "tau,n") == ["tau,nle"]


@pytest.mark.parametrize("shell, form", [("zsh", "zsh"), ("fish", "fish"), ("bash", "bash")])
def test_shells_read_it(shell, form, tmp_path):
    if not shutil.which(shell):
        pytest.skip(f"{shell} is not installed")
    file = tmp_path / "dyn"
    file.write_text(run("manual", form))
    done = subprocess.run([shell, "-n", str(file)], capture_output=True, text=True)
    assert done.returncode == 0 and done.stderr == ""


def test_an_unknown_form():
    assert "man" in run("manual", "powershell", status=2)
