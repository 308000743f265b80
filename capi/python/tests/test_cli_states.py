"""States that the command reads from files."""

import pytest
from command import GO2, answer, arm_file, pytestmark, run, state_file  # noqa: F401 (fixtures)


def test_state_by_joint(arm_file, arm, state_file):
    path = state_file({"q": {"elbow": 0.5}, "v": {"shoulder": [2]}})
    found = answer("eval", arm_file, "--fixed", "--compute", "nle", "--state", path)
    assert found["nle"] == arm.data().compute_nle([0, 0.5], [2, 0]).tolist()


@pytest.mark.parametrize(
    "content, words",
    [
        ("{", ["not JSON"]),
        ("", ["not JSON"]),
        ("[1, 2]", ["object"]),
        ('{"q": [1, NaN]}', ["not JSON"]),
        ('{"q":\n [1, 1e999]}', [':2: "1e999" is beyond the range of a double']),
        ('{"q": [[1, 2]]}', ['"q"[0] must be a number, but is [1,2]']),
        ('{"ctrl": [[1]]}', ['"ctrl"[0] must be a number']),
        ('{"q": [1, 2, 3]}', ['"q"', "3", "2"]),
        ('{"v": [1]}', ['"v"', "1", "2"]),
        ('{"q": [1, "x"]}', ['"q"[1]', "number"]),
        ('{"q": [1, null]}', ['"q"[1]']),
        ('{"q": [1, true]}', ['"q"[1]']),
        ('{"q": 5}', ["list"]),
        ('{"position": [1, 2]}', ['"position"', '"tau"']),
        ('{"q": {"knee": 1}}', ["knee"]),
        ('{"q": {"elbow": [1, 2]}}', ["elbow", "2", "1"]),
    ],
)
def test_bad_states(arm_file, state_file, content, words):
    path = state_file(content)
    error = run("eval", arm_file, "--fixed", "--compute", "g", "--state", path, status=1)
    assert str(path) in error and all(w in error for w in words)


def test_more_bad_states(arm_file, tmp_path):
    words = ("eval", arm_file, "--fixed", "--compute", "g")
    assert "No such file" in run(*words, "--state", tmp_path / "none.json", status=1)
    run(*words, "--state", tmp_path, status=1)
    error = run(*words, "--q", "1,2,3", status=1)
    assert "--q has 3 numbers" in error and "2 (nq)" in error
    assert "wrist" in run(*words, "--frame", "wrist", status=1)
    error = run("eval", GO2, "--floating", "--compute", "g", "--q", ",".join(["0"] * 19), status=1)
    assert "quaternion" in error
