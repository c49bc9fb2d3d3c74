#!/usr/bin/env python3
"""Time-optimal path parameterisation by toppra (seidel, acceleration rows at both ends of every cell).

Reads a request per line and answers each with a line, both JSON. A request is a path:

    {"s": [...], "first": [[...], ...], "second": [[...], ...], "velocity": [...], "acceleration": [...]}

s rises; first and second are the derivatives of the axes by s, a list per node; the limits are one per axis. A number
takes the path before once more, so many times, without reading it again. The answer is

    {"duration": s, "construct": s, "solve": s, "squared": [...]}

duration is the sum of 2·h/(sqrt(b_k) + sqrt(b_k+1)), null where toppra fails; construct and solve are how long building
the constraints and the instance, and compute_parameterization, have taken (medians). squared, the squared rate of s at
the nodes, comes only with a path whose "profile" is true.

The derivatives are taken as they are at the nodes and s is scaled to end at 1 (toppra's tolerances are absolute), so
that another planner can be given the same rows.
"""

import json
import logging
import statistics
import sys
import time

import numpy as np

import toppra
from toppra import algorithm, constraint
from toppra.interpolator import AbstractGeometricPath


class Given(AbstractGeometricPath):
    """A path that is known at the nodes of a grid alone."""

    def __init__(self, nodes, first, second):
        self.nodes = nodes
        self.orders = {1: first, 2: second}

    def __call__(self, positions, order=0):
        if order not in self.orders:
            raise ValueError("positions are not given")
        at = np.searchsorted(self.nodes, positions)
        if not np.array_equal(self.nodes[at], positions):
            raise ValueError("not a node of the grid")
        return self.orders[order][at]

    @property
    def dof(self):
        return self.orders[1].shape[1]

    @property
    def path_interval(self):
        return np.array([self.nodes[0], self.nodes[-1]])

    @property
    def waypoints(self):
        return None


class Problem:
    def __init__(self, request):
        s = np.array(request["s"], dtype=float)
        self.scale = s[-1] - s[0]
        self.nodes = (s - s[0]) / self.scale
        self.nodes[-1] = 1.0
        self.first = np.array(request["first"], dtype=float) * self.scale
        self.second = np.array(request["second"], dtype=float) * self.scale**2
        self.velocity = np.array(request["velocity"], dtype=float)
        self.acceleration = np.array(request["acceleration"], dtype=float)
        self.profile = bool(request.get("profile", False))

    def solve(self):
        path = Given(self.nodes, self.first, self.second)
        start = time.perf_counter()
        constraints = [
            constraint.JointVelocityConstraint(self.velocity),
            constraint.JointAccelerationConstraint(
                self.acceleration, discretization_scheme=constraint.DiscretizationType.Interpolation
            ),
        ]
        instance = algorithm.TOPPRA(constraints, path, gridpoints=self.nodes, solver_wrapper="seidel")
        built = time.perf_counter()
        _, rate, _ = instance.compute_parameterization(0.0, 0.0)
        end = time.perf_counter()
        return rate, built - start, end - built

    def answer(self, runs):
        times = []
        for _ in range(runs):
            rate, construct, solve = self.solve()
            times.append((construct, solve))
        duration, squared = None, None
        if rate is not None and np.all(np.isfinite(rate)):
            duration = float(np.sum(2.0 * np.diff(self.nodes) / (rate[:-1] + rate[1:])))
            duration = duration if np.isfinite(duration) else None
            squared = ((rate * self.scale) ** 2).tolist()
        answer = {
            "duration": duration,
            "construct": statistics.median(construct for construct, _ in times),
            "solve": statistics.median(solve for _, solve in times),
        }
        if self.profile:
            answer["squared"] = squared
        return answer


def main():
    toppra.setup_logging(level="ERROR")
    logging.getLogger("toppra").setLevel(logging.ERROR)
    problem = None
    for line in sys.stdin:
        request = json.loads(line)
        if isinstance(request, dict):
            problem, runs = Problem(request), 1
        else:
            runs = int(request)
        print(json.dumps(problem.answer(runs)), flush=True)


if __name__ == "__main__":
    main()
