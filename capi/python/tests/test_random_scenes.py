"""Random scenes gain no energy that nothing explains, keep to max_iterations, and end in finite numbers or a named error.
bench/random_scenes.py plays 1,000."""

import pytest
import random_scenes as scenes

# Springs and servos on mass ratios of 1e10 and more, soft contacts that explode, gains that add up over many steps, and a closing
# that projections correct.
HARD = [78, 159, 367, 371, 388, 529, 647, 693, 802]


@pytest.mark.parametrize("seeds", [range(0, 25), range(25, 50), range(50, 75), HARD], ids=lambda seeds: f"from {seeds[0]}")
def test_random_scenes_gain_no_energy(seeds):
    for seed in seeds:
        result = scenes.play(scenes.scene(seed))
        assert result.finite, seed
        assert result.gain <= scenes.SHARE * result.scale, (seed, result)
        assert result.beyond == 0, (seed, result)
