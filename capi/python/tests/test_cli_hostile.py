"""Command lines and state files that nobody writes on purpose: refused with a reason on one line, or answered for what they say."""

import math
import os
import threading

import pytest
from command import GO2, answer, arm_file, pytestmark, run, state_file  # noqa: F401 (fixtures)

EVAL = ("eval", GO2, "--fixed", "--compute", "g")
SIM = ("sim", GO2, "--fixed", "--duration", "0.01")


def short(x):
    """pytest puts it into the environment of what the tests start."""
    return str(x)[:60]


@pytest.mark.parametrize(
    "words, said",
    [
        (["INFO", GO2], ['no subcommand "INFO"', "they are info"]),
        ([""], ['no subcommand ""']),
        (["inf", GO2], ['did you mean "info"']),
        (["info", GO2, "--floting"], ['no option "--floting"', 'did you mean "--floating"']),
        (["sim", GO2, "--floating", "--grond=0"], ['no option "--grond"', 'did you mean "--ground"']),
        (["info", GO2, "--zzzzzzzz"], ['no option "--zzzzzzzz"; dyn info --help']),
        (["%s%n"], ['no subcommand "%s%n"']),
        (["x" * 100000], ["no subcommand", "..."]),
        (["info", GO2, GO2, "--fixed"], ["not expected"]),
        (["info", GO2, "--fixed=maybe"], ["--fixed = maybe"]),
        (["info", GO2, "-fixed"], ["not expected: -fixed"]),
        (["info", GO2, "--fixed", "--package-dir"], ["--package-dir", "missing"]),
        (["info", GO2, "--fixed", "--package-dir", ""], ["--package-dir", "empty"]),
        ([*EVAL, "--frame", ""], ["--frame", "empty"]),
        ([*EVAL, "--frame", "a", "--frame", "b"], ["--frame"]),
        ([*EVAL, "--state", ""], ["--state", "empty"]),
        ([*EVAL, "--q", "1e400"], ["--q", '"1e400" is beyond the range of a double']),
        ([*EVAL, "--q", "0x1"], ["--q", '"0x1" is not a number']),
        ([*EVAL, "--q", "--v", "1"], ["--q", '"--v" is not a number']),
        ([*EVAL, "--compute", "%n%s"], ['"%n%s"']),
        ([*SIM, "--csv", ""], ["--csv", "empty"]),
        ([*SIM, "--duration", "1"], ["--duration"]),
        ([*EVAL, "--q", "1,,2"], ["--q: there is nothing between two commas"]),
        ([*EVAL, "--q", ",1,2"], ["--q: there is nothing before the first comma"]),
        ([*EVAL, "--q", "1,2,"], ["--q: there is nothing behind the last comma"]),
        ([*EVAL, "--q", "1;2"], ["--q", '"1;2" is not a number']),
        ([*EVAL, "--q", "1 [2]"], ["--q", '"[2]" is not a number']),
        ([*EVAL, "--compute", "tau,,M"], ["--compute: there is nothing between"]),
        ([*EVAL, "--effects", "armature,,damping"], ["--effects: there is nothing between"]),
        ([*EVAL, "--effects", "armature,"], ["--effects: there is nothing behind"]),
        ([*EVAL, "--effects", "all,none"], ["--effects", '"none" stands alone']),
        ([*EVAL, "--effects", " "], ["--effects: the list is empty"]),
        (["ik", GO2, "--seed", "-1"], ["--seed", '"-1" is no whole number']),
        (["ik", GO2, "--seed", "99999999999999999999"], ["--seed", "is no whole number"]),
        (["ik", GO2, "--restarts", "010"], ["--restarts", "is no whole number"]),
        (["ik", GO2, "--tolerance", "0x1"], ["--tolerance", '"0x1" is not a number']),
        ([*SIM, "--dt", "1,5"], ["--dt", '"1,5" is not a number']),
        ([*SIM, "--dt", ""], ["--dt", '"" is not a number']),
        ([*SIM, "--dt", "0x10"], ["--dt", '"0x10" is not a number']),
        ([*SIM, "--dt", "nan"], ['--dt: "nan" is no positive number of seconds']),
        ([*SIM, "--dt", "0"], ['--dt: "0" is no positive number of seconds']),
        ([*SIM, "--dt", "1e400"], ["--dt", "is beyond the range of a double"]),
        ([*SIM, "--max-iterations", "0x10"], ["--max-iterations", '"0x10" is no whole number']),
        ([*SIM, "--accuracy", "0"], ["--accuracy must be a positive number"]),
        ([*SIM, "--accuracy", ""], ["--accuracy", '"" is not a number']),
        ([*SIM, "--time-budget", ""], ["--time-budget", '"" is not a number']),
        ([*SIM, "--dt", "1e-300"], ["steps", "larger --dt"]),
        ([*SIM, "--integrator", "RK4"], ['"RK4"', "rk4"]),
        (["bench", GO2, "--fixed", "--seconds", "-1"], ["--seconds must be a positive number"]),
        (["bench", GO2, "--fixed", "--seconds", "nan"], ["--seconds must be a positive number"]),
    ],
    ids=short,
)  # fmt: skip
def test_bad_usage(words, said):
    error = run(*words, status=2)
    assert all(s in error for s in said), error
    assert len(error) < 1500


@pytest.mark.parametrize(
    "content, said",
    [
        ('{"q": [1, 2]}\0', ["zero byte"]),
        ('{"q": [1, 2], "q": [3, 4]}', ['"q" stands there twice']),
        ('{"q": {"elbow": 1, "elbow": 2}}', ['"elbow" stands there twice']),
        ('{"q": {"elbow\\u0000": 1}}', ["zero byte"]),
        ('{"q": ' + "[" * 200000 + "]" * 200000 + "}", ["nested deeper"]),
        ('{"q": {"elbow": ' + "[" * 200000 + "]" * 200000 + "}}", ["nested deeper"]),
        ("[" * 200000, ["nested deeper"]),
        ('{"' + "k" * 1000000 + '": 1}', ["unknown key", "..."]),
        ('{"q": {"%s%n": 1}}', ["no joint '%s%n'"]),
        ('{"q": {"a\\nb": 1}}', ["no joint 'a b'"]),
        ('{"q": [1, 2],}', ["not JSON", "line 1"]),
        ('{"q": [0x1, 2]}', ["not JSON"]),
        ('{"q": {"universe": 1}}', ['"universe"', "0"]),
    ],
    ids=short,
)  # fmt: skip
def test_bad_states(arm_file, state_file, content, said):  # noqa: F811
    path = state_file(content)
    error = run("eval", arm_file, "--fixed", "--compute", "g", "--state", path, status=1)
    assert str(path) in error and all(s in error for s in said), error[:1000]
    assert len(error) < 1500 and error.count("\n") == 1


def test_states_that_never_end(arm_file, tmp_path):  # noqa: F811
    words = ("eval", arm_file, "--fixed", "--compute", "g", "--state")
    assert "Is a directory" in run(*words, tmp_path, status=1)
    if os.path.exists("/dev/zero"):
        assert "which is the limit" in run(*words, "/dev/zero", status=1)


def test_state_through_a_pipe(arm_file, tmp_path):  # noqa: F811
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    writer = threading.Thread(target=lambda: pipe.write_text('\ufeff{"q": [0.5, 0.25]}', "utf-8"))
    writer.start()
    words = ("eval", arm_file, "--fixed", "--compute", "g")
    assert answer(*words, "--state", pipe) == answer(*words, "--q", "0.5,0.25")
    writer.join()


@pytest.mark.parametrize(
    "words, options",
    [
        ("sim r --csv r", ["FILE", "--csv"]),
        ("sim r --postmortem r", ["FILE", "--postmortem"]),
        ("sim r --html link", ["FILE", "--html"]),
        ("sim r --state s --csv hard", ["--state", "--csv"]),
        ("sim r --tau-csv s --html ./s", ["--tau-csv", "--html"]),
        ("sim r --csv a --html ../FOLDER/a", ["--csv", "--html"]),
        ("sim r --csv dangling --postmortem nothing", ["--csv", "--postmortem"]),
        ("accuracy r --csv r", ["FILE", "--csv"]),
        ("accuracy r --reference s --csv s", ["--reference", "--csv"]),
        ("accuracy r --csv a --svg a", ["--csv", "--svg"]),
        ("accuracy r --resume a --html a", ["--html", "--resume"]),
        ("accuracy r --resume r", ["FILE", "--resume"]),
        ("info r --srdf s --html s", ["--srdf", "--html"]),
        ("view r --state s --html s", ["--state", "--html"]),
        ("convert r r", ["FILE", "OUT"]),
        ("convert r link", ["FILE", "OUT"]),
    ],
)  # fmt: skip
def test_what_is_read_is_not_written(tmp_path, words, options):
    (tmp_path / "r").write_text("the robot"), (tmp_path / "s").write_text("read, too")
    os.link(tmp_path / "s", tmp_path / "hard")
    (tmp_path / "link").symlink_to("r"), (tmp_path / "dangling").symlink_to("nothing")
    duration = ["--duration", "0.01"] if words.startswith("sim") else []
    error = run(*words.replace("FOLDER", tmp_path.name).split(), *duration, status=2, cwd=tmp_path)
    assert f"{options[0]} and {options[1]} name the same file" in error
    assert (tmp_path / "r").read_text() == "the robot" and (tmp_path / "s").read_text() == "read, too"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["dangling", "hard", "link", "r", "s"]


def test_devices_may_be_named_twice(arm_file):  # noqa: F811
    run("sim", arm_file, *SIM[2:], "--csv", "/dev/null", "--postmortem", "/dev/null")


@pytest.mark.parametrize("words", [["sim", GO2, "--csv", "-", "--duration", "1"], ["view", GO2, "--html", "-"],
                                   ["stress", "--html", "-"], ["convert", GO2, "-"], ["accuracy", GO2, "--svg", "-"]])
def test_a_dash_is_no_file(words, tmp_path):
    assert "/dev/stdout" in run(*words, status=2, cwd=tmp_path) and not list(tmp_path.iterdir())


@pytest.mark.parametrize("words", [["accuracy", "--budget", "100min", "--csv"], ["accuracy", "--budget", "100min", "--svg"],
                                   ["accuracy", "--budget", "100min", "--html"], ["accuracy", "--budget", "100min", "--resume"],
                                   ["sim", "--duration", "1e5", "--postmortem"], ["stress", "--long", "--html"]])  # fmt: skip
def test_what_cannot_be_written_is_said_first(words, arm_file, tmp_path):  # noqa: F811
    robot = [] if words[0] == "stress" else [arm_file, "--fixed"]
    for out, why in ((tmp_path / "none/x", "No such file"), (tmp_path, "Is a directory")):
        error = run(words[0], *robot, *words[1:], out, status=1)
        assert f"{out}: cannot be written: " in error and why in error
    assert [p.name for p in tmp_path.iterdir()] == ["arm.urdf"]


def test_the_recommended_command_can_be_run(arm_file):  # noqa: F811
    said = answer("accuracy", arm_file, "--fixed", "--q", "0.1,", "0.2", "--v", "[0.3, 0.4]", "--duration", "0.01", "--budget",
                  "1s", "--target", "1m")
    command = said["recommended"]["command"].split()
    assert "0.1,0.2" in command and answer(*command[1:])["time"] == pytest.approx(0.01)


def test_points_need_a_file(arm_file):  # noqa: F811
    assert "/dev/full: cannot be written" in run("accuracy", arm_file, "--fixed", "--resume", "/dev/full", status=1)


def test_robots_that_cannot_move(tmp_path):
    path = tmp_path / "rock.urdf"
    path.write_text('<robot name="rock"><link name="rock"/></robot>')
    names = "tau,ddq,M,Minv,nle,g,coriolis,com,vcom,acom,Jcom,J,dJ,energy,placements,subtree_com,frame_acceleration,Ag,hg,regressor"
    found = answer("eval", path, "--fixed", "--compute", names, "--frame", "rock")
    assert found["tau"] == [] and found["M"] == [] and found["vcom"] == [0, 0, 0] and found["frame_acceleration"] == [0] * 6
    assert answer("sim", path, "--fixed", "--duration", "0.01")["time"] == pytest.approx(0.01)
    assert answer("bench", path, "--fixed", "--seconds", "0.05")["algorithms"]


def test_names_of_all_kinds(tmp_path):
    path = tmp_path / "a b%s%n'.urdf"
    solid = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    name = "%s%n 'a/b' [c], --fixed \U0001f9be"
    path.write_text(
        f'<robot name="{name}"><link name="a">{solid}</link><link name="b">{solid}</link>'
        f'<joint name="{name}" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>',
        "utf-8",
    )
    info = answer("info", path, "--fixed")
    assert info["name"] == name and info["joints"][1]["name"] == name and name in run("info", path, "--fixed")
    assert answer("eval", path, "--fixed", "--compute", "J", f"--frame={name}")["J"][5] == [1]
    error = run("info", tmp_path / "a\nb\x1b.urdf", status=1)
    assert "a b .urdf: cannot be opened" in error


def test_huge_numbers(tmp_path, arm_file):  # noqa: F811
    words = ("sim", arm_file, "--fixed", "--duration", "0.01")
    assert "too large" in run(*words, "--v", "1e308,0", status=1)
    assert "smaller dt" in run(*words, "--tau", "1e308,1e308", status=1)
    found = answer(*words, "--q", "1e308,-1e308")
    assert all(math.isfinite(x) for x in found["q"])
