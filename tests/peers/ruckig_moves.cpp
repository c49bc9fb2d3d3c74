// Time per move of Ruckig's C++ library.
//
// Usage: ruckig_moves FILE. The file has a move per line: position, velocity, acceleration, target, end velocity, and
// the limits of velocity, acceleration, deceleration and jerk. Prints the ns per move of the fastest of some passes
// over them, and the sum of the durations.

#include <chrono>
#include <cstdio>
#include <fstream>
#include <limits>
#include <vector>

#include <ruckig/ruckig.hpp>

int main(int count, char** arguments) {
    if (count != 2) {
        return 2;
    }
    std::ifstream file(arguments[1]);
    std::vector<ruckig::InputParameter<1>> moves;
    double v[9];
    while (file >> v[0] >> v[1] >> v[2] >> v[3] >> v[4] >> v[5] >> v[6] >> v[7] >> v[8]) {
        ruckig::InputParameter<1> move;
        move.current_position = {v[0]};
        move.current_velocity = {v[1]};
        move.current_acceleration = {v[2]};
        move.target_position = {v[3]};
        move.target_velocity = {v[4]};
        move.target_acceleration = {0.0};
        move.max_velocity = {v[5]};
        move.max_acceleration = {v[6]};
        move.min_acceleration = {-v[7]};
        move.max_jerk = {v[8]};
        moves.push_back(move);
    }
    ruckig::Ruckig<1> ruckig;
    ruckig::Trajectory<1> trajectory;
    double least = std::numeric_limits<double>::infinity(), sum = 0.0;
    for (int pass = 0; pass < 30; ++pass) {
        sum = 0.0;
        const auto start = std::chrono::steady_clock::now();
        for (const auto& move : moves) {
            if (ruckig.calculate(move, trajectory) == ruckig::Result::Working) {
                sum += trajectory.get_duration();
            }
        }
        const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
        least = std::min(least, time.count() / double(moves.size()));
    }
    std::printf("%.3f %.17g\n", least, sum);
}
