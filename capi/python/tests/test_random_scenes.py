"""Random scenes gain no energy that nothing explains, and end in finite numbers or a named error. bench/random_scenes.py plays
1,000."""

import pytest
import random_scenes as scenes


@pytest.mark.parametrize("first", range(0, 150, 25))
def test_random_scenes_gain_no_energy(first):
    for seed in range(first, first + 25):
        result = scenes.play(scenes.scene(seed))
        assert result.finite, seed
        assert result.gain <= scenes.SHARE * result.scale, (seed, result)
