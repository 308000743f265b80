"""Learns to control a robot by proximal policy optimisation (PPO), in numpy.

    python learn.py                                   # the cart-pole, in about ten seconds
    python learn.py go2 --actions 4e6 --out go2       # a quadruped learns to walk; go2.npz, go2.csv, go2.mp4

Ctrl-C ends it early. Robots are libdyn.gym's: all of a batch take an action in one call. The policy is a normal distribution about
a network of two layers of tanh; a second network estimates the value of an observation. Schulman et al. 2017; advantages as in
Schulman et al. 2016. Observations are normalised by their running mean and deviation, rewards by the deviation of the return.
"""

import argparse
import csv
import sys
import time

import numpy as np

import libdyn as dyn
from libdyn.gym import TaskEnv, TaskVectorEnv

GAMMA, LAMBDA, CLIP = 0.99, 0.95, 0.2
GOALS = {"cart_pole": 475.0}  # mean return of an episode, of at most 500


class Network:
    """Layers of tanh, the last one linear, with Adam."""

    def __init__(self, sizes, random, last):
        self.weights = []
        for n, m in zip(sizes, sizes[1:]):
            scale = last if m == sizes[-1] else np.sqrt(2)
            self.weights += [scale * np.linalg.qr(random.normal(size=(max(n, m), min(n, m))))[0].reshape(n, m)
                             if n >= m else scale * np.linalg.qr(random.normal(size=(m, n)))[0].T, np.zeros(m)]
        self.extra = []  # more numbers that learn
        self.steps, self.moments = 0, None

    def __call__(self, x):
        self.layers = [x]
        for k in range(0, len(self.weights), 2):
            x = x @ self.weights[k] + self.weights[k + 1]
            if k + 2 < len(self.weights):
                x = np.tanh(x)
            self.layers.append(x)
        return x

    def gradient(self, dy):
        """Of the weights, from that of the last outputs."""
        out = []
        for k in reversed(range(0, len(self.weights), 2)):
            x = self.layers[k // 2]
            out = [x.T @ dy, dy.sum(0), *out]
            dy = (dy @ self.weights[k].T) * (1 - x * x)
        return out

    def descend(self, gradient, rate):
        numbers = self.weights + self.extra
        size = np.sqrt(sum(np.sum(g * g) for g in gradient))
        gradient = [g * min(1, 0.5 / (size + 1e-12)) for g in gradient]
        if self.moments is None:
            self.moments = [(np.zeros_like(w), np.zeros_like(w)) for w in numbers]
        self.steps += 1
        a, b = 1 - 0.9**self.steps, 1 - 0.999**self.steps
        for w, g, (m, v) in zip(numbers, gradient, self.moments):
            m += 0.1 * (g - m)
            v += 0.001 * (g * g - v)
            w -= rate * (m / a) / (np.sqrt(v / b) + 1e-8)


class Running:
    """Mean and variance of what was seen."""

    def __init__(self, shape):
        self.n, self.mean, self.var = 1e-4, np.zeros(shape), np.ones(shape)

    def add(self, x):
        n, d = self.n + len(x), x.mean(0) - self.mean
        self.var = (self.var * self.n + x.var(0) * len(x) + d * d * self.n * len(x) / n) / n
        self.mean, self.n = self.mean + d * len(x) / n, n


class Learner:
    def __init__(self, envs, seed, hidden):
        self.random, self.envs = np.random.default_rng(seed), envs
        n, self.actions = envs.single_observation_space.shape[0], envs.single_action_space.shape[0]
        self.policy = Network([n, *hidden, self.actions], self.random, 0.01)
        self.policy.extra = [np.full(self.actions, -0.5)]  # logarithms of deviations
        self.value = Network([n, *hidden, 1], self.random, 1.0)
        self.seen, self.returns = Running(n), Running(())
        self.observation = envs.reset(seed=seed)[0]
        self.ended = np.zeros(envs.num_envs, bool)
        self.sum, self.discounted = np.zeros(envs.num_envs), np.zeros(envs.num_envs)
        self.episodes = []

    def normal(self, observation):
        return np.clip((observation - self.seen.mean) / np.sqrt(self.seen.var + 1e-8), -10, 10)

    def act(self, observation):
        """The mean of the policy."""
        return self.policy(self.normal(observation))

    def collect(self, steps):
        """Observations, actions, logarithms of their probabilities, advantages and returns of so many steps."""
        n, dev = self.envs.num_envs, np.exp(self.policy.extra[0])
        rows = {"x": [], "a": [], "p": [], "v": [], "r": [], "end": [], "cut": [], "real": []}
        for _ in range(steps):
            self.seen.add(self.observation)
            x = self.normal(self.observation)
            noise = self.random.normal(size=(n, self.actions))
            a = self.policy(x) + dev * noise
            rows["x"].append(x), rows["a"].append(a), rows["p"].append(-0.5 * np.sum(noise**2, 1) - self.policy.extra[0].sum())
            rows["v"].append(self.value(x)[:, 0]), rows["real"].append(~self.ended)  # a step after an end only resets
            self.observation, reward, end, cut, _ = self.envs.step(a)
            self.sum += reward
            self.discounted = self.discounted * GAMMA + reward
            self.returns.add(self.discounted)
            rows["r"].append(reward / np.sqrt(self.returns.var + 1e-8)), rows["end"].append(end), rows["cut"].append(cut)
            self.ended = end | cut
            self.episodes += self.sum[self.ended].tolist()
            self.sum[self.ended] = self.discounted[self.ended] = 0
        rows = {name: np.array(x) for name, x in rows.items()}
        after = np.concatenate([rows["v"][1:], self.value(self.normal(self.observation)).T])  # where an episode was cut, too
        error = rows["r"] + GAMMA * after * ~rows["end"] - rows["v"]
        advantage, carried = np.zeros_like(error), 0.0
        for k in reversed(range(steps)):
            advantage[k] = carried = error[k] + GAMMA * LAMBDA * carried * ~(rows["end"] | rows["cut"])[k]
        real = rows["real"]
        return rows["x"][real], rows["a"][real], rows["p"][real], advantage[real], (advantage + rows["v"])[real]

    def learn(self, x, a, p, advantage, returns, rate, epochs=5, batch=2048):
        advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
        for _ in range(epochs):
            order = self.random.permutation(len(x))
            for k in range(0, len(x) - batch // 2, batch):
                i = order[k : k + batch]
                log_dev = self.policy.extra[0]
                z = (a[i] - self.policy(x[i])) / np.exp(log_dev)
                ratio = np.exp(-0.5 * np.sum(z * z, 1) - log_dev.sum() - p[i])
                held = np.where(advantage[i] > 0, ratio > 1 + CLIP, ratio < 1 - CLIP)  # by the clip
                slope = np.where(held, 0, -advantage[i] * ratio)[:, None] / len(i)  # of the loss by the logarithm
                self.policy.descend([*self.policy.gradient(slope * z / np.exp(log_dev)), np.sum(slope * (z * z - 1), 0)], rate)
                np.clip(log_dev, -2.5, 0.5, out=log_dev)
                self.value.descend(self.value.gradient((self.value(x[i])[:, 0] - returns[i])[:, None] / len(i)), rate)


def train(robot, goal, actions, envs, steps, seed, hidden, rate, curve, **options):
    """Until the mean return of 100 episodes is the goal, or so many actions; returns the learner, and that mean."""
    learner = Learner(TaskVectorEnv(robot, envs, **options), seed, hidden)
    begin, done, mean, told = time.monotonic(), 0, -np.inf, -np.inf
    try:
        while done < actions and mean < goal:
            learner.learn(*learner.collect(steps), rate * max(1 - done / actions, 0.05))
            done += envs * steps
            mean = float(np.mean(learner.episodes[-100:])) if len(learner.episodes) >= 20 else -np.inf
            seconds = time.monotonic() - begin
            curve.append((done, seconds, mean))
            if seconds > told + 2:
                told = seconds
                print(f"{done:9d} actions, {seconds:6.1f} s: mean return of an episode {mean:.1f}", flush=True)
    except KeyboardInterrupt:
        print("ended by a key: the policy is as it was learned so far")
    return learner, mean


def film(robot, learner, path, seconds=10.0, **options):
    """A video of the policy without noise; returns the return of its episode."""
    env = TaskEnv(robot, **options)
    observation, _ = env.reset(seed=7)
    total, over = 0.0, False
    with env.simulation.record() as recording:
        while not over and env.simulation.time < seconds:
            observation, reward, over, _, _ = env.step(learner.act(observation[None])[0])
            total += reward
    recording.to_mp4(path)
    return total


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("robot", nargs="?", default="cart_pole", help="cart_pole, reach, lift, go2, humanoid")
    parser.add_argument("--actions", type=float, default=1e6)
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--steps", type=int, default=64, help="actions of an environment between updates")
    parser.add_argument("--goal", type=float, help="mean return at which it ends; of the cart-pole 475, of others none")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--hidden", type=int, nargs="+", default=[64, 64])
    parser.add_argument("--rate", type=float, default=1e-3, help="of learning")
    parser.add_argument("--out", help="writes OUT.npz, the networks, OUT.csv, the curve, and OUT.mp4")
    given = parser.parse_args(arguments)
    goal = GOALS.get(given.robot, np.inf) if given.goal is None else given.goal
    curve = []
    learner, mean = train(given.robot, goal, given.actions, given.envs, given.steps, given.seed, given.hidden, given.rate, curve)
    done, seconds, _ = curve[-1]
    print(f"{given.robot}: mean return {mean:.1f} after {done} actions and {seconds:.0f} s")
    if given.out:
        np.savez(f"{given.out}.npz", *learner.policy.weights, mean=learner.seen.mean, var=learner.seen.var)
        with open(f"{given.out}.csv", "w", newline="") as file:
            csv.writer(file).writerows([("actions", "seconds", "mean return"), *curve])
        print(f"the policy without noise: return {film(given.robot, learner, given.out + '.mp4'):.1f} in {given.out}.mp4")
    return 0 if mean >= goal or goal == np.inf else 1


if __name__ == "__main__":
    sys.exit(main())
