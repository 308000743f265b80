"""`dyn distance`: distances between the shapes of a robot."""

import pytest
from command import GO2, answer, arm_file, pytestmark, run  # noqa: F401 (fixtures)


def test_distance(go2):
    found = answer("distance", GO2, "--floating")
    distances = go2.data().compute_distances(go2.neutral())
    assert [p["distance"] for p in found["pairs"]] == sorted(distances.tolist())
    assert found["collisions"] == 0 and {p["status"] for p in found["pairs"]} == {"separated"}
    nearest = found["pairs"][0]
    assert distances[nearest["pair"]] == nearest["distance"] and {nearest["a"], nearest["b"]} & {"base", "FL_thigh"}
    text = run("distance", GO2, "--floating")
    assert f"{len(distances)} pairs, 0 in collision" in text and "--pairs" in text and text.count("separated") == 10
    assert run("distance", GO2, "--floating", "--pairs").count("separated") == len(distances)
    values = answer("eval", GO2, "--floating", "--compute", "distances,collisions,distance_gradients")
    assert len(values["distances"]) == len(values["distance_gradients"]) == go2.npairs and values["collisions"] == []
    pairs = answer("info", GO2, "--floating", "--pairs")["pairs"]
    assert sum(p["tested"] for p in pairs) == go2.npairs
    assert {p["reason"] for p in pairs} == {"tested", "they belong to one body", "a body and its parent"}
    assert "pairs of collision shapes" in run("info", GO2, "--floating", "--pairs")


def test_distance_sweep(arm_file):
    found = answer("distance", GO2, "--floating", "--sweep", "--samples", "20")
    assert found["reference"] == 1e-15 and found["states"] == 21
    rows = found["sweep"]
    kinds = list(dict.fromkeys(r["kind"] for r in rows))
    assert kinds[-1] == "all" and {"box-cylinder", "cylinder-cylinder"} <= set(kinds)
    gjk = [r for r in rows if r["method"] == "gjk"]
    assert len(gjk) == 11 * len(kinds)
    assert [r["tolerance"] for r in gjk[:11]] == pytest.approx([10.0**-k for k in range(2, 13)])
    assert len(rows) in (len(gjk), 2 * len(gjk))  # with libccd, and without
    total = [r for r in gjk if r["kind"] == "all"]
    for row, tolerance in zip(total, [10.0**-k for k in range(2, 13)]):
        assert (row["failed"] == 0
                and row["queries"] == row["by_method"] == sum(r["queries"] for r in gjk if r["tolerance"]
                                                              == row["tolerance"]) / 2)
        assert 0 <= row["median_error"] <= row["max_error"] <= tolerance + 1e-14  # shapes are smaller than 1 m
        assert 1e-9 < row["wall_s"] < 1e-3
    assert total[0]["max_error"] > total[-1]["max_error"]
    assert all(r["by_method"] <= r["queries"] for r in rows)
    text, here = (f("distance", GO2, "--floating", "--sweep", "--samples", "0") for f in (run, answer))
    assert "tolerance" in text and text.count("\n") == 1 + sum(r["by_method"] > 0 for r in here["sweep"])
    assert "no pair" in run("distance", arm_file, "--fixed", "--sweep")
    assert answer("distance", arm_file, "--fixed", "--sweep")["sweep"] == []
    assert "--sweep" in run("distance", GO2, "--floating", "--samples", "3", status=2)
    assert "samples" in run("distance", GO2, "--floating", "--sweep", "--samples", "-1", status=2)


def test_distance_without_shapes(arm_file):
    assert "no pair" in run("distance", arm_file, "--fixed")
