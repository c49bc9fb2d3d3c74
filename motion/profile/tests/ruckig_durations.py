"""Durations of the fastest motions of single axes by Ruckig.

Reads lines `position velocity acceleration target end_velocity velocity_limit acceleration_limit deceleration_limit
jerk_limit` from the file named as argument and prints a duration for each, or why there is none.
"""

import sys

from ruckig import InputParameter, Result, Ruckig, Trajectory

ruckig, trajectory = Ruckig(1), Trajectory(1)
case = InputParameter(1)
case.target_acceleration = [0.0]
with open(sys.argv[1], encoding="ascii") as cases:
    for line in cases:
        values = [[float(word)] for word in line.split()]
        case.current_position, case.current_velocity, case.current_acceleration = values[:3]
        case.target_position, case.target_velocity = values[3:5]
        case.max_velocity, case.max_acceleration = values[5:7]
        case.min_acceleration, case.max_jerk = [-values[7][0]], values[8]
        try:
            result = ruckig.calculate(case, trajectory)
        except Exception as error:
            print(f"error {error}".replace("\n", " "))
            continue
        print(trajectory.duration if result == Result.Working else f"error {result}")
