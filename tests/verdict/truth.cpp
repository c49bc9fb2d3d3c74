// Seeded test programs with known violations, and their true axis extremes.
//
// An independent computation next to `twin check`: own interpreter, path, velocity profile and kinematics, written from
// the SoftMotion manual (2.3; chapters 3.2, 6.2.7, 6.2.9 and 8.2), sampled at 100 kHz of program time.
// Every quantity is a Jet (value, velocity, acceleration), so that derivatives are exact at each sample. Both ends of every
// piece of the profile are samples too, so that one-sided values at junctions are exact.
//
//   truth generate MACHINE SEED FIRST COUNT FOLDER   writes FOLDER/INDEX.cnc or .ngc, prints one line of truth per program
//   truth judge MACHINE PROGRAM                      prints the line of truth of one program
//
// MACHINE is the flat text that verdict.py makes of a machine file: "key number number …". Units: mm, degrees, seconds.
// A line of truth: "file kind target factor duration reach", then per axis "name min max velocity acceleration step jump";
// below it the same for every line of the program that moves: "+ line reach", then per axis as above.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <vector>

using std::string;
using Vec3 = std::array<double, 3>;
constexpr double CYCLE_S = 1e-3;
constexpr double PI = 3.14159265358979323846, DEG = 180 / PI, INF = 1e300;

/// Distance of the samples: 100 kHz, and closer in short pieces, so that fast turns are resolved as well.
/// While a program is fitted to its target, a number per piece is enough.
struct Sampling {
    double step_s;
    int per_piece;
};
constexpr Sampling FINE{1e-5, 2000}, COARSE{1e9, 300};

// ---------------------------------------------------------------------------------------------- derivatives over time

/// A value with its first and second derivative over time.
struct Jet {
    double p = 0, v = 0, a = 0;
    Jet(double p = 0, double v = 0, double a = 0) : p(p), v(v), a(a) {}
};
Jet operator+(Jet x, Jet y) { return {x.p + y.p, x.v + y.v, x.a + y.a}; }
Jet operator-(Jet x, Jet y) { return {x.p - y.p, x.v - y.v, x.a - y.a}; }
Jet operator*(Jet x, Jet y) { return {x.p * y.p, x.v * y.p + x.p * y.v, x.a * y.p + 2 * x.v * y.v + x.p * y.a}; }
/// Chain rule for f(x) with f, f', f'' at x.
Jet chain(Jet x, double f, double f1, double f2) { return {f, f1 * x.v, f2 * x.v * x.v + f1 * x.a}; }
Jet root(Jet x) { double r = std::sqrt(x.p); return chain(x, r, 0.5 / r, -0.25 / (r * x.p)); }
Jet sine(Jet x) { double s = std::sin(x.p), c = std::cos(x.p); return chain(x, s, c, -s); }
Jet cosine(Jet x) { double s = std::sin(x.p), c = std::cos(x.p); return chain(x, c, -s, -c); }
/// Angle of the vector (x, y). Its rate is the cross product with the velocity over the square of the length.
Jet angle(Jet y, Jet x) {
    double square = x.p * x.p + y.p * y.p, cross = x.p * y.v - y.p * x.v;
    double cross_rate = x.p * y.a - y.p * x.a, square_rate = 2 * (x.p * x.v + y.p * y.v);
    return {std::atan2(y.p, x.p), cross / square, (cross_rate - cross * square_rate / square) / square};
}

// ------------------------------------------------------------------------------------------------------------- machine

struct Axis {
    string name;
    double min, max, velocity, acceleration, step;
    bool limited() const { return max < 1e6; }
    double travel() const { return limited() ? max - min : 360; }
};

struct Machine {
    string name, kind;
    std::map<string, std::vector<double>> number;
    std::vector<Axis> axes;
    double get(const string& key, size_t i = 0) const { return number.at(key).at(i); }
};

Machine read_machine(const string& file) {
    Machine machine;
    std::ifstream in(file);
    for (string line; std::getline(in, line);) {
        std::istringstream words(line);
        string key;
        words >> key;
        if (key == "kind") words >> machine.kind;
        else if (key == "name") words >> machine.name;
        else if (key == "axis") {
            Axis axis;
            words >> axis.name >> axis.min >> axis.max >> axis.velocity >> axis.acceleration >> axis.step;
            machine.axes.push_back(axis);
        } else for (double x; words >> x;) machine.number[key].push_back(x);
    }
    return machine;
}

/// Axis positions of the tool tip at (x, y, z) with the tool direction `heading` (radians); false: out of reach.
/// `margin` is the distance of the wrist, or of the most stretched rod, from the edge of the reach in mm.
bool solve_axes(const Machine& m, Jet x, Jet y, Jet z, Jet heading, Jet* axis, double& margin) {
    margin = INF;
    z = z + m.get("tool_length");
    if (m.kind == "scara3" || m.kind == "gantry_cutter3") {  // the tool's offset turns with the tool
        Jet c = cosine(heading), s = sine(heading);
        double ahead = m.get("tool_offset", 0), left = m.get("tool_offset", 1);
        x = x - c * ahead + s * left;
        y = y - s * ahead - c * left;
    }
    if (m.kind == "gantry3" || m.kind == "gantry3_tool2" || m.kind == "gantry_cutter3") {
        double a = m.get("tool_angle") / DEG, ahead = m.get("tool_ahead"), left = m.get("tool_left");
        axis[0] = x + (m.get("offsets", 0) - ahead * std::cos(a) + left * std::sin(a));
        axis[1] = y + (m.get("offsets", 1) - ahead * std::sin(a) - left * std::cos(a));
        axis[2] = z + m.get("offsets", 2);
        axis[3] = heading * (DEG * m.get("sense_r")) + m.get("offset_r");
    } else if (m.kind == "gantry_h2") {  // two motors pull one belt: same sense moves y, opposite sense x
        Jet along = m.get("belt_exchanged") ? x : y, across = m.get("belt_exchanged") ? y : x;
        axis[0] = along + across;
        axis[1] = along - across;
        axis[2] = z;
    } else if (m.kind == "scara2" || m.kind == "scara3") {
        double l1 = m.get("arms", 0), l2 = m.get("arms", 1);
        if (m.kind == "scara3") {
            x = x - cosine(heading) * m.get("arms", 2);
            y = y - sine(heading) * m.get("arms", 2);
        }
        Jet square = x * x + y * y;
        double r = std::sqrt(square.p);
        margin = std::min(l1 + l2 - r, r - std::fabs(l1 - l2));
        if (margin <= 0) return false;
        // Law of cosines for the elbow. sin B from Heron's product, which stays exact near the edge of the reach.
        Jet cosine_b = (square - (l1 * l1 + l2 * l2)) * (1 / (2 * l1 * l2));
        Jet product = (square - (l1 - l2) * (l1 - l2)) * ((l1 + l2) * (l1 + l2) - square);
        Jet sine_b = root(product) * (m.get("elbow") / (2 * l1 * l2));
        Jet b = angle(sine_b, cosine_b);
        Jet a = angle(y, x) - angle(sine_b * l2, cosine_b * l2 + l1);
        axis[0] = a * DEG + m.get("offsets", 0);
        axis[1] = b * DEG + m.get("offsets", 1);
        if (m.kind == "scara3") axis[2] = (heading - a - b) * DEG + m.get("offsets", 2);
        axis[m.kind == "scara3" ? 3 : 2] = z;
    } else if (m.kind == "tripod") {
        double half = m.get("rod_distance") / 2, rod = m.get("rod_length");
        double e = std::sqrt(m.get("outer") * m.get("outer") - half * half) -
                   std::sqrt(m.get("inner") * m.get("inner") - half * half);
        for (int i = 0; i < 3; ++i) {
            double phi = (m.get("rotation") + 120 * i) / DEG;
            Jet dx = x - e * std::cos(phi), dy = y - e * std::sin(phi), square = dx * dx + dy * dy;
            margin = std::min(margin, rod - std::sqrt(square.p));
            if (margin <= 0) return false;
            axis[i] = z + root(Jet(rod * rod) - square) + m.get("offsets", i);
        }
    } else {
        std::fprintf(stderr, "unknown kind %s\n", m.kind.c_str());
        std::exit(2);
    }
    return true;
}

// ---------------------------------------------------------------------------------------------------------------- path

/// A line or an arc about the vertical (with a rise: a helix), in the machine frame.
struct Element {
    int line = 0;          // of the program, from 1
    bool arc = false, rapid = false, jump_before = false;  // jump: the position was set (G92) between two elements
    Vec3 from{}, to{};
    double centre[2] = {0, 0}, radius = 0, angle0 = 0, sweep = 0;  // radians, counter-clockwise above 0
    double length = 0, feed = 0, acceleration = 0, deceleration = 0;
    double heading0 = 0, heading_rate = 0;                         // radians, radians per mm of path

    void measure() {
        double rise = to[2] - from[2];
        double plan = arc ? std::fabs(sweep) * radius : std::hypot(to[0] - from[0], to[1] - from[1]);
        length = std::hypot(plan, rise);
    }
    bool vertical() const { return !arc && std::hypot(to[0] - from[0], to[1] - from[1]) < 1e-9; }
    void place(Jet s, Jet* xyz) const {
        Jet part = s * (1 / length);
        for (int i = 0; i < 3; ++i) xyz[i] = part * (to[i] - from[i]) + from[i];
        if (!arc) return;
        Jet u = part * sweep + angle0;
        xyz[0] = cosine(u) * radius + centre[0];
        xyz[1] = sine(u) * radius + centre[1];
    }
    Vec3 tangent(double s) const {
        Jet xyz[3];
        place(Jet(s, 1, 0), xyz);
        return {xyz[0].v, xyz[1].v, xyz[2].v};
    }
};

/// Interpreter of the words that the generator writes, in both dialects.
struct Interpreter {
    const Machine& machine;
    bool din;
    std::vector<Element> path;
    Vec3 at{}, work{}, shift{};  // position, work offset and G92 offset, all in the program's frame
    double feed = 0, acceleration = 100, deceleration = 100;  // the manual's default (6.5)
    bool relative = false, jump = false;
    int motion = 1, line = 0;

    Interpreter(const Machine& m, bool din) : machine(m), din(din) {
        for (int i = 0; i < 3; ++i) at[i] = m.get("start", i);
        if (!din) acceleration = m.get("rs274", 1), deceleration = m.get("rs274", 2), motion = -1;
    }

    void block(const string& text) {
        ++line;
        std::map<char, double> word;
        std::vector<int> g;
        const char* c = text.c_str();
        while (*c) {
            if (*c == '%') return;
            if (*c == ' ') { ++c; continue; }
            char letter = *c++, *end;
            double value = std::strtod(c, &end);
            c = end;
            if (letter == 'G') g.push_back(int(value));
            else if (letter == 'E') (value > 0 ? acceleration : deceleration) = std::fabs(value);
            else if (letter == 'F') feed = din ? value : value / 60;
            else word[letter] = value;
        }
        bool set_position = false;
        for (int code : g) {
            if (code <= 3) motion = code;
            else if (code == 90) relative = false;
            else if (code == 91) relative = true;
            else if (code == 92) set_position = true;
            else if (code >= 54 && code <= 59)
                for (int i = 0; i < 3; ++i) work[i] = machine.get("work_offsets", (code - 54) * 3 + i);
        }
        if (set_position) set(word);
        else if (word.count('X') || word.count('Y') || word.count('Z') || word.count('I') || word.count('J')) move(word);
    }

    /// G92: DIN 66025 moves the set-point at once; RS274 moves the coordinates and not the machine.
    void set(std::map<char, double>& word) {
        for (int i = 0; i < 3; ++i) {
            auto found = word.find("XYZ"[i]);
            if (found == word.end()) continue;
            if (din) at[i] = found->second, jump = !path.empty();
            else shift[i] = at[i] - work[i] - found->second;
        }
    }

    void move(std::map<char, double>& word) {
        Element e;
        e.line = line;
        e.from = at;
        for (int i = 0; i < 3; ++i) {
            auto found = word.find("XYZ"[i]);
            if (found != word.end()) at[i] = found->second + (relative ? at[i] : work[i] + shift[i]);
        }
        e.to = at;
        e.rapid = motion == 0;
        e.jump_before = jump, jump = false;
        e.feed = e.rapid && !din ? machine.get("rs274", 0) : feed;
        e.acceleration = acceleration, e.deceleration = deceleration;
        if (motion >= 2) bend(e, word);
        for (int i = 0; i < 3; ++i) e.from[i] += machine.get("work_frame", i), e.to[i] += machine.get("work_frame", i);
        for (int i = 0; i < 2; ++i) e.centre[i] += machine.get("work_frame", i);
        e.measure();
        if (e.length > 1e-9) path.push_back(e);
    }

    void bend(Element& e, std::map<char, double>& word) {
        double dx = e.to[0] - e.from[0], dy = e.to[1] - e.from[1], chord = std::hypot(dx, dy);
        double sense = motion == 3 ? 1 : -1;
        e.arc = true;
        if (word.count('R')) {  // less than half a circle: the centre is left of the chord for G3, right for G2
            double h = std::sqrt(std::max(0.0, word['R'] * word['R'] - chord * chord / 4));
            e.centre[0] = e.from[0] + dx / 2 - sense * h * dy / chord;
            e.centre[1] = e.from[1] + dy / 2 + sense * h * dx / chord;
        } else e.centre[0] = e.from[0] + word['I'], e.centre[1] = e.from[1] + word['J'];
        double x = e.from[0] - e.centre[0], y = e.from[1] - e.centre[1];
        e.radius = std::hypot(x, y), e.angle0 = std::atan2(y, x);
        double turn = (std::atan2(e.to[1] - e.centre[1], e.to[0] - e.centre[0]) - e.angle0) * sense;
        while (turn < 0) turn += 2 * PI;
        if (chord < 1e-7) turn = 2 * PI;
        e.sweep = sense * turn;
    }
};

/// Heading of the tool along the path. It turns by the shortest way between elements and holds on vertical moves.
void set_headings(const Machine& m, std::vector<Element>& path) {
    bool from_path = m.get("direction_from_path");
    double turn = m.get("direction") / DEG, heading = turn;
    auto own = [](const Element& e) { Vec3 t = e.tangent(0); return std::atan2(t[1], t[0]); };
    if (from_path)
        for (auto& e : path) if (!e.vertical()) { heading = own(e) + turn; break; }
    for (auto& e : path) {
        if (from_path && !e.vertical()) heading += std::remainder(own(e) + turn - heading, 2 * PI);
        e.heading0 = heading;
        e.heading_rate = from_path && e.arc ? e.sweep / e.length : 0;
        heading += e.heading_rate * e.length;
    }
}

/// RS274 has no words for accelerations and the velocity of rapids. Each element has the most that the axes allow at the
/// weakest of its points: no farther apart than 5 mm, at most 33. In bends, half of an acceleration is kept for the path.
void set_pace(const Machine& m, Element& e) {
    constexpr double DISTANCE = 5, SPARE = 0.5;
    int parts = int(std::min(32.0, std::max(2.0, std::ceil(e.length / DISTANCE))));
    std::vector<std::array<Jet, 4>> points;
    for (int i = 0; i <= parts; ++i) {
        Jet xyz[3];
        std::array<Jet, 4> axis;  // rates by the length of the path
        double margin;
        e.place(Jet(e.length * i / parts, 1, 0), xyz);
        if (solve_axes(m, xyz[0], xyz[1], xyz[2], m.get("direction") / DEG, axis.data(), margin)) points.push_back(axis);
        else if (i == 0) return;
    }
    auto weakest = [&](auto of) {
        double least = INF;
        for (auto& point : points)
            for (size_t i = 0; i < m.axes.size(); ++i)
                least = std::min(least, of(m.axes[i], std::max(1e-12, std::fabs(point[i].v)), std::fabs(point[i].a)));
        return least;
    };
    if (e.rapid)
        e.feed = std::min(e.feed, weakest([&](const Axis& axis, double rate, double bend) {
            return std::min(axis.velocity / rate, std::sqrt((1 - SPARE) * axis.acceleration / std::max(1e-12, bend)));
        }));
    double most = weakest([&](const Axis& axis, double rate, double bend) {
        return std::max(axis.acceleration - bend * e.feed * e.feed, SPARE * axis.acceleration) / rate;
    });
    e.acceleration = std::min(e.acceleration, most), e.deceleration = std::min(e.deceleration, most);
}

std::vector<Element> interpret(const Machine& m, const string& text, bool din) {
    Interpreter interpreter(m, din);
    std::istringstream in(text);
    for (string line; std::getline(in, line);) interpreter.block(line);
    set_headings(m, interpreter.path);
    if (!din) for (auto& e : interpreter.path) set_pace(m, e);
    return interpreter.path;
}

// ------------------------------------------------------------------------------------------------------------- profile

/// Part of the velocity profile with constant acceleration.
struct Piece {
    int element;
    double t0, duration, s0, v0, a;
};

double turn_between(const Vec3& a, const Vec3& b) {
    double dot = 0, square = 0, cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    for (int i = 0; i < 3; ++i) dot += a[i] * b[i], square += cross[i] * cross[i];
    return std::atan2(std::sqrt(square), dot) * DEG;
}

/// Trapezoids by F and E. A transition has velocity 0 at G0, at jumps and at turns beyond the angle tolerance, otherwise
/// the smaller F (manual 3.2); look-ahead lowers it to what the lengths allow.
std::vector<Piece> plan(const Machine& m, const std::vector<Element>& path) {
    size_t n = path.size();
    std::vector<double> joint(n + 1, 0);
    for (size_t i = 1; i < n; ++i) {
        const Element &a = path[i - 1], &b = path[i];
        bool stop = a.rapid || b.rapid || b.jump_before ||
                    turn_between(a.tangent(a.length), b.tangent(0)) > m.get("angle_tolerance");
        joint[i] = stop ? 0 : std::min(a.feed, b.feed);
    }
    for (size_t i = n; i-- > 0;)
        joint[i] = std::min(joint[i], std::sqrt(joint[i + 1] * joint[i + 1] + 2 * path[i].deceleration * path[i].length));
    for (size_t i = 0; i < n; ++i)
        joint[i + 1] = std::min(joint[i + 1], std::sqrt(joint[i] * joint[i] + 2 * path[i].acceleration * path[i].length));
    std::vector<Piece> pieces;
    double t = 0;
    for (size_t i = 0; i < n; ++i) {
        const Element& e = path[i];
        double v0 = joint[i], v1 = joint[i + 1], a = e.acceleration, d = e.deceleration, s = 0;
        double peak = std::min(e.feed, std::sqrt((2 * a * d * e.length + d * v0 * v0 + a * v1 * v1) / (a + d)));
        peak = std::max({peak, v0, v1});
        double up = (peak * peak - v0 * v0) / (2 * a), down = (peak * peak - v1 * v1) / (2 * d);
        auto add = [&](double duration, double v, double acceleration, double distance) {
            if (duration > 1e-12) pieces.push_back({int(i), t, duration, s, v, acceleration}), t += duration;
            s += distance;
        };
        add((peak - v0) / a, v0, a, up);
        add((e.length - up - down) / peak, peak, 0, e.length - up - down);
        add((peak - v1) / d, peak, -d, down);
    }
    return pieces;
}

// --------------------------------------------------------------------------------------------------------------- truth

/// An extreme value with its place: element and part of the element's length.
struct Extreme {
    double value = 0, part = 0;
    int element = -1;
    void raise(double x, int e, double at) { if (x > value || element < 0) value = x, element = e, part = at; }
};

struct AxisTruth {
    Extreme low, high, velocity, acceleration, step;  // low: negative position
    double jump = 0;                                   // largest change of the position at once

    void raise(const AxisTruth& other) {
        Extreme AxisTruth::*all[] = {&AxisTruth::low, &AxisTruth::high, &AxisTruth::velocity, &AxisTruth::acceleration,
                                     &AxisTruth::step};
        for (auto one : all)
            if ((other.*one).element >= 0) (this->*one).raise((other.*one).value, (other.*one).element, (other.*one).part);
        jump = std::max(jump, other.jump);
    }
};

struct Truth {
    std::vector<AxisTruth> axis;
    double reach = INF, duration = 0;  // reach: smallest margin, mm
    std::vector<std::vector<AxisTruth>> of_element;
    std::vector<double> reach_of_element;
    std::vector<Element> path;
};

Truth judge(const Machine& m, const string& text, bool din, Sampling sampling) {
    Truth truth;
    truth.path = interpret(m, text, din);
    size_t count = m.axes.size();
    truth.axis.resize(count);
    truth.of_element.assign(truth.path.size(), truth.axis);
    truth.reach_of_element.assign(truth.path.size(), INF);
    Jet last[4], now[4];
    int last_element = -1;  // -1: nothing to compare with
    struct Joint { double time; double change[4]; };
    std::deque<Joint> joints;  // of the last cycle: what velocities change there is one step
    double turns[4] = {0, 0, 0, 0}, before[4];
    bool started = false;
    for (const Piece& piece : plan(m, truth.path)) {
        const Element& e = truth.path[piece.element];
        bool first = true;
        auto sample = [&](double t) {
            double v = piece.v0 + piece.a * t;
            Jet s(piece.s0 + (piece.v0 + 0.5 * piece.a * t) * t, v, piece.a), xyz[3];
            e.place(s, xyz);
            double margin;
            bool reached = solve_axes(m, xyz[0], xyz[1], xyz[2], s * e.heading_rate + e.heading0, now, margin);
            double& reach = truth.reach_of_element[piece.element];
            reach = std::min(reach, margin);
            if (!reached) { last_element = -1; joints.clear(); return; }
            bool jumps = e.jump_before && last_element != piece.element, joins = first && last_element >= 0 && !jumps;
            if (first && jumps) joints.clear();
            if (joins) {
                while (!joints.empty() && joints.front().time <= piece.t0 - CYCLE_S * (1 - 1e-9)) joints.pop_front();
                joints.push_back({piece.t0, {}});
            }
            for (size_t i = 0; i < count; ++i) {
                // Angles of arms begin within half a turn and then go on from turn to turn; headings do by themselves.
                if (m.kind[0] == 's' && i + 1 < count) {
                    double reference = started ? before[i] : 0;
                    turns[i] = 360 * std::round((reference - now[i].p) / 360);
                    now[i].p += turns[i];
                }
                AxisTruth& a = truth.of_element[piece.element][i];
                double part = s.p / e.length;
                a.low.raise(-now[i].p, piece.element, part);
                a.high.raise(now[i].p, piece.element, part);
                a.velocity.raise(std::fabs(now[i].v), piece.element, part);
                a.acceleration.raise(std::fabs(now[i].a), piece.element, part);
                if (joins) {
                    double change = std::fabs(now[i].v - last[i].v), sum = 0;
                    joints.back().change[i] = now[i].v - last[i].v;
                    for (const Joint& joint : joints) sum += joint.change[i];
                    // Only corners that are passed add up; where the path begins to move nothing does.
                    bool adds = piece.v0 >= 1e-3 * e.feed && change > 1e-6;
                    a.step.raise(adds ? std::max(std::fabs(sum), change) : change, piece.element, 0);
                    a.jump = std::max(a.jump, std::fabs(now[i].p - last[i].p));
                }
                before[i] = now[i].p;
            }
            first = false;
            started = true;
            last_element = piece.element;
            std::copy(now, now + count, last);
        };
        sample(0);
        double step = std::min(sampling.step_s, piece.duration / sampling.per_piece);
        for (long i = 1; i * step < piece.duration; ++i) sample(i * step);
        sample(piece.duration);
        truth.duration = piece.t0 + piece.duration;
    }
    for (size_t e = 0; e < truth.path.size(); ++e) {
        truth.reach = std::min(truth.reach, truth.reach_of_element[e]);
        for (size_t i = 0; i < count; ++i) truth.axis[i].raise(truth.of_element[e][i]);
    }
    return truth;
}

void print_axes(const Machine& m, const std::vector<AxisTruth>& axes) {
    for (size_t i = 0; i < m.axes.size(); ++i) {
        const AxisTruth& a = axes[i];
        std::printf(" %s %.12g %.12g %.12g %.12g %.12g %.12g", m.axes[i].name.c_str(), -a.low.value, a.high.value,
                    a.velocity.value, a.acceleration.value, a.step.value, a.jump);
    }
    std::printf("\n");
}

void print(const Machine& m, const string& file, const string& label, const Truth& truth) {
    std::printf("%s %s %.9g %.9g", file.c_str(), label.c_str(), truth.duration, truth.reach);
    print_axes(m, truth.axis);
    for (size_t e = 0; e < truth.path.size(); ++e) {
        std::printf("+ %d %.9g", truth.path[e].line, truth.reach_of_element[e]);
        print_axes(m, truth.of_element[e]);
    }
}

// ----------------------------------------------------------------------------------------------------------- generator

enum Kind { ARC, SAMPLES, JUNCTION, UNWRAPPING, INCREMENTAL, OFFSET, START, END, SINGULAR, REACH, KINDS };
const char* KIND_NAMES[] = {"inside-arc", "between-samples", "junction", "unwrapping", "incremental",
                            "offset", "start", "end", "near-singularity", "outside-reach"};
enum Target { POSITION, VELOCITY, ACCELERATION, STEP, NO_TARGET };
const char* TARGET_NAMES[] = {"position", "velocity", "acceleration", "step", "reach"};

/// Random numbers that are the same with every standard library.
struct Random {
    std::mt19937_64 engine;
    bool round = false;  // lengths in whole mm and angles in steps, as people write programs
    double step_deg = 15;
    double between(double a, double b) { return a + (b - a) * double(engine() >> 11) / 9007199254740992.0; }
    int below(int n) { return int(between(0, n)); }
    bool chance(double p) { return between(0, 1) < p; }
    double length(double a, double b) { double x = between(a, b); return round ? std::max(1.0, std::round(x)) : x; }
    double turn(double a, double b) {  // radians
        double x = between(a, b) * DEG;
        if (round && std::fabs(x) > 7.5) x = std::copysign(step_deg * std::max(1.0, std::round(std::fabs(x) / step_deg)), x);
        return x / DEG;
    }
    double one_of(std::vector<double> list) { return list[below(int(list.size()))]; }
};

struct Move {
    int g;
    Vec3 to;
    double centre[2] = {0, 0};
    bool by_radius = false;
    double feed_factor = 1, acceleration_factor = 1;
};

/// Program before its scaling: a path in the machine frame, nominal F and E, and the way in which it is written.
struct Draft {
    bool din = true, relative = false;
    int work_offset = 0;          // 1 … 5: G55 … G59
    bool set_position = false;    // G92 after the first moves
    bool round = false;           // F and E in whole numbers
    Vec3 start{};
    std::vector<Move> moves;
    double feed = 100, acceleration = 1000, deceleration = 1000, heading = 0;

    Vec3 end() const { return moves.empty() ? start : moves.back().to; }
    void line(double length, double rise = 0) {
        Vec3 p = end();
        moves.push_back({1, {p[0] + length * std::cos(heading), p[1] + length * std::sin(heading), p[2] + rise}});
    }
    /// Arc that begins in the direction of `heading`; sweep in radians, counter-clockwise above 0.
    void arc(double radius, double sweep, double rise, bool by_radius) {
        Vec3 p = end();
        double side = sweep > 0 ? 1 : -1, out = heading - side * PI / 2;
        Move move{sweep > 0 ? 3 : 2, p, {p[0] - radius * std::cos(out), p[1] - radius * std::sin(out)}, by_radius};
        if (std::fabs(std::fabs(sweep) - 2 * PI) > 1e-9)
            move.to = {move.centre[0] + radius * std::cos(out + sweep), move.centre[1] + radius * std::sin(out + sweep), 0};
        move.to[2] = p[2] + rise;
        moves.push_back(move);
        heading += sweep;
    }
};

/// Changes by which a draft is fitted to its target: a factor on F (its square on E), a shift and a turn about the origin.
struct Fit {
    double k = 1, shift[3] = {0, 0, 0}, turn = 0;
};

string number(double x) {
    char text[64];
    std::snprintf(text, sizeof text, "%.9f", x);
    string s = text;
    s.erase(s.find_last_not_of('0') + 1);
    if (s.back() == '.') s.pop_back();
    return s == "-0" ? "0" : s;
}

/// Text of a program. Every coordinate is rounded as it is written, so relative targets count from the rounded position.
string render(const Machine& m, const Draft& draft, const Fit& fit) {
    std::ostringstream out;
    int block_number = 10;
    double c = std::cos(fit.turn), s = std::sin(fit.turn), base[3];
    auto round9 = [](double x) { return std::strtod(number(x).c_str(), nullptr); };
    for (int i = 0; i < 3; ++i) base[i] = m.get("work_frame", i);
    auto placed = [&](Vec3 p) {
        return Vec3{c * p[0] - s * p[1] + fit.shift[0] - base[0], s * p[0] + c * p[1] + fit.shift[1] - base[1],
                    p[2] + fit.shift[2] - base[2]};
    };
    auto speed = [&](double x) { return number(draft.round ? std::max(1.0, std::round(x)) : x); };
    auto begin = [&] { if (draft.din) out << "N" << block_number << " ", block_number += 10; };
    Vec3 offset{}, at;
    auto coordinates = [&](Vec3 p, bool relative) {
        for (int i = 0; i < 3; ++i) {
            double x = round9(relative ? p[i] - at[i] : p[i] - offset[i]);
            out << " " << "XYZ"[i] << number(x);
            at[i] = relative ? at[i] + x : x + offset[i];
        }
    };
    if (draft.din) {
        out << "% VERDICT\n";
        begin();
        out << "G92";
        coordinates(placed(draft.start), false);
        out << "\n";
    } else {
        out << "G21 G90 G17";
        if (draft.work_offset) {
            out << " G" << 54 + draft.work_offset;
            for (int i = 0; i < 3; ++i) offset[i] = m.get("work_offsets", draft.work_offset * 3 + i);
        }
        out << "\nG0";
        coordinates(placed(draft.start), false);
        out << "\n";
        if (draft.set_position) {
            out << "G92 X1 Y-2 Z3\n";
            for (int i = 0; i < 3; ++i) offset[i] = at[i] - (i == 0 ? 1 : i == 1 ? -2 : 3);
        }
    }
    if (draft.relative) { begin(); out << "G91\n"; }
    for (int pass = 0; pass < (draft.din && draft.set_position ? 2 : 1); ++pass) {
        if (pass) {  // the path once more from its start, moved a little
            begin();
            out << "G92";
            coordinates(placed(draft.start), false);
            out << "\n";
        }
        for (size_t i = 0; i < draft.moves.size(); ++i) {
            const Move& move = draft.moves[i];
            Vec3 from = at, target = placed(move.to), centre = placed({move.centre[0], move.centre[1], 0});
            begin();
            out << "G" << move.g;
            Vec3 begins = placed(i ? draft.moves[i - 1].to : draft.start);
            bool full = std::hypot(target[0] - begins[0], target[1] - begins[1]) < 1e-9 && move.g >= 2;
            if (full) target[0] = from[0], target[1] = from[1];
            coordinates(target, draft.relative);
            if (move.g >= 2 && move.by_radius)
                out << " R" << number(std::hypot(target[0] - centre[0], target[1] - centre[1]));
            else if (move.g >= 2) out << " I" << number(centre[0] - from[0]) << " J" << number(centre[1] - from[1]);
            out << " F" << speed(draft.feed * move.feed_factor * fit.k * (draft.din ? 1 : 60));
            double e = move.acceleration_factor * fit.k * fit.k;
            if (draft.din && (i == 0 || move.acceleration_factor != draft.moves[i - 1].acceleration_factor))
                out << " E" << speed(draft.acceleration * e) << " E-" << speed(draft.deceleration * e);
            out << "\n";
        }
    }
    if (!draft.din) out << "M2\n";
    return out.str();
}

// Paths of the kinds. Lengths in mm; angles in radians.

void add_arc(Draft& d, Random& r, double sweep_max = 2 * PI) {
    double radius = std::exp(r.between(std::log(2), std::log(60)));
    if (r.round) radius = std::round(radius);
    double sweep = r.turn(0.3, sweep_max), side = r.chance(0.5) ? 1 : -1;
    bool by_radius = r.chance(0.4);
    if (by_radius) sweep = std::min(sweep, r.turn(0.3, 1.6));
    else if (r.chance(0.1)) sweep = 2 * PI;
    d.arc(radius, side * sweep, r.chance(0.3) ? r.between(-6, 6) : 0, by_radius);
}

void add_arc_path(Draft& d, Random& r) {
    if (r.chance(0.6)) d.line(r.length(5, 40));
    add_arc(d, r);
    if (r.chance(0.4)) add_arc(d, r, PI);
    if (r.chance(0.6)) d.line(r.length(5, 40));
}

void add_corners(Draft& d, Random& r, double least_deg, double most_deg) {
    if (most_deg < 3 && r.chance(0.3)) {  // a curve of short chords: several corners within a cycle
        double side = r.chance(0.5) ? 1 : -1, chord = std::exp(r.between(std::log(0.02), std::log(0.5)));
        for (int i = 10 + r.below(20); i-- > 0;) {
            d.line(chord);
            d.heading += side * r.between(0.5 * most_deg, most_deg) / DEG;
        }
        return;
    }
    int lines = 2 + r.below(4);
    for (int i = 0; i < lines; ++i) {
        d.line(r.length(5, 30), r.chance(0.2) ? r.between(-0.05, 0.05) : 0);
        d.heading += (r.chance(0.5) ? 1 : -1) * r.turn(least_deg / DEG, most_deg / DEG);
    }
}

void add_any(Draft& d, Random& r) {
    if (r.chance(0.5)) add_arc_path(d, r);
    else add_corners(d, r, 0.3, r.chance(0.5) ? 1.8 : 80);
}

/// Path along or towards an edge of the reach; `depth` mm inside of it (outside below 0).
void add_edge_path(const Machine& m, Draft& d, Random& r, double depth) {
    double z = d.start[2], length = r.between(20, 80);
    Vec3 nearest;
    double along;  // direction in which the path passes the edge
    if (m.kind == "tripod") {
        // Opposite a column the distance to its rods' circle is largest.
        double half = m.get("rod_distance") / 2, outer = m.get("outer"), inner = m.get("inner");
        double e = std::sqrt(outer * outer - half * half) - std::sqrt(inner * inner - half * half);
        double phi = (m.get("rotation") + 120 * r.below(3)) / DEG, angle = phi + PI + r.between(-0.3, 0.3);
        double rod = m.get("rod_length") - depth;
        nearest = {e * std::cos(phi) + rod * std::cos(angle), e * std::sin(phi) + rod * std::sin(angle), z};
        along = angle;
    } else {
        double l1 = m.get("arms", 0), l2 = m.get("arms", 1), angle = r.between(-1.5, 1.0);
        bool hole = r.chance(0.3);
        double radius = hole ? std::fabs(l1 - l2) + depth : l1 + l2 - depth;
        double hand = m.kind == "scara3" ? m.get("arms", 2) : 0, direction = m.get("direction") / DEG;
        nearest = {radius * std::cos(angle) + hand * std::cos(direction),
                   radius * std::sin(angle) + hand * std::sin(direction), z};
        along = hole ? angle + PI : angle;
    }
    double side = r.chance(0.5) ? 1 : -1;
    int shape = r.below(3);
    if (shape == 0) {  // straight to the edge, and back where the path has to stop anyway
        double slant = along + r.between(-1.2, 1.2);
        d.heading = slant;
        d.start = {nearest[0] - length * std::cos(slant), nearest[1] - length * std::sin(slant), z};
        d.moves.push_back({1, nearest});
        d.heading = slant + PI + r.between(-0.5, 0.5);
        if (r.chance(0.5)) d.line(length / 2);
    } else if (shape == 1) {  // a line that is tangential to the edge
        d.heading = along + side * PI / 2;
        d.start = {nearest[0] - length * std::cos(d.heading), nearest[1] - length * std::sin(d.heading), z};
        d.line(2 * length);
    } else {  // an arc that bulges towards the edge
        double radius = r.between(10, 60), half_sweep = r.between(0.4, 1.4);
        double centre[2] = {nearest[0] - radius * std::cos(along), nearest[1] - radius * std::sin(along)};
        double begin = along - side * half_sweep;
        d.start = {centre[0] + radius * std::cos(begin), centre[1] + radius * std::sin(begin), z};
        d.heading = begin + side * PI / 2;
        d.arc(radius, side * 2 * half_sweep, 0, r.chance(0.5) && half_sweep < 1.3);
    }
}

/// Path around the first arm's axis, over the side where angles go from 180 to -180 degrees; on cutters full turns.
void add_unwrapping(const Machine& m, Draft& d, Random& r) {
    if (m.kind == "gantry_cutter3") {
        for (int turns = 1 + r.below(2); turns-- > 0;)
            d.arc(r.length(5, 40), (r.chance(0.5) ? 1 : -1) * r.turn(3, 2 * PI), 0, false);
        return;
    }
    double radius = r.length(150, 400), z = d.start[2], side = r.chance(0.5) ? 1 : -1;
    double begin = side * r.turn(1.8, 3.0), sweep = side * r.turn(0.3, 2.5);
    d.start = {radius * std::cos(begin), radius * std::sin(begin), z};
    d.heading = begin + side * PI / 2;
    if (r.chance(0.7)) d.arc(radius, r.chance(0.3) ? side * 2 * PI : sweep, r.chance(0.3) ? r.between(-6, 6) : 0, false);
    else d.line(r.between(50, 400));
}

/// A comfortable start: every axis in the middle part of its travel.
bool choose_start(const Machine& m, Draft& d, Random& r) {
    for (int tries = 0; tries < 1000; ++tries) {
        d.start = {r.between(-450, 650), r.between(-450, 450), r.between(-160, 120)};
        if (r.round) for (double& x : d.start) x = std::round(x);
        Jet axis[4];
        double margin;
        if (!solve_axes(m, d.start[0], d.start[1], d.start[2], m.get("direction") / DEG, axis, margin) || margin < 30) continue;
        bool inside = true;
        for (size_t i = 0; i < m.axes.size(); ++i) {
            const Axis& a = m.axes[i];
            if (!a.limited()) continue;
            inside &= axis[i].p > a.min + 0.2 * a.travel() && axis[i].p < a.max - 0.2 * a.travel();
        }
        if (inside) return true;
    }
    return false;
}

bool make_draft(const Machine& m, Kind kind, bool din, Draft& d, Random& r) {
    d.din = din;
    r.round = d.round = r.chance(0.4);
    r.step_deg = r.one_of({15, 90, 90});
    if (!choose_start(m, d, r)) return false;
    d.heading = r.turn(-PI, PI);
    d.feed = std::exp(r.between(std::log(20), std::log(400)));
    d.acceleration = std::exp(r.between(std::log(300), std::log(6000)));
    d.deceleration = d.acceleration * (r.chance(0.5) ? 1 : std::exp(r.between(-1, 1)));
    switch (kind) {
        case ARC: add_arc_path(d, r); break;
        case SAMPLES:  // a few milliseconds: extremes fall between the set-points of the cycles
            d.feed = 1e3;
            if (r.chance(0.6)) d.line(r.between(0.02, 1.5), r.chance(0.3) ? r.between(-0.5, 0.5) : 0);
            else d.arc(r.between(0.2, 1.5), r.between(-2.5, 2.5), 0, r.chance(0.5));
            break;
        case JUNCTION: add_corners(d, r, 0.2, 1.85); if (r.chance(0.4)) add_arc(d, r); break;
        case UNWRAPPING: add_unwrapping(m, d, r); break;
        case INCREMENTAL: d.relative = true; add_any(d, r); break;
        case OFFSET:
            add_any(d, r);
            d.set_position = d.din || r.chance(0.6);
            d.work_offset = d.din || (d.set_position && r.chance(0.5)) ? 0 : 1 + r.below(5);
            break;
        case START: d.deceleration = d.acceleration / r.between(1.5, 4); add_any(d, r); break;
        case END: d.deceleration = d.acceleration * r.between(1.5, 4); add_any(d, r); break;
        case SINGULAR: add_edge_path(m, d, r, std::exp(r.between(std::log(0.02), std::log(5)))); break;
        case REACH: add_edge_path(m, d, r, r.one_of({0.02, 0.5, -0.005, -0.1, -1, -10}) * r.between(0.5, 1)); break;
        default: return false;
    }
    if (r.chance(0.2)) for (auto& move : d.moves) move.feed_factor = r.one_of({1, 0.7, 0.4});
    if (r.chance(0.1)) for (auto& move : d.moves) move.acceleration_factor = r.one_of({1, 0.5, 0.2});
    if (r.chance(0.1))
        for (auto& move : d.moves) if (move.g == 1 && r.chance(0.4)) move.g = 0;
    return !d.moves.empty();
}

/// Whether the extreme lies where its kind wants it.
bool in_place(Kind kind, const Truth& truth, const Extreme& e) {
    bool inner = e.part > 1e-3 && e.part < 1 - 1e-3;
    if (kind == ARC) return inner && truth.path[e.element].arc;
    if (kind == JUNCTION) return !inner;
    if (kind == START) return e.element == 0;
    if (kind == END) return e.element == int(truth.path.size()) - 1;
    return true;
}

/// Moves or turns the path until an axis reaches `goal`; secant method on the coordinate that moves it.
bool fit_position(const Machine& m, const Draft& d, Fit& fit, int axis, bool upper, double goal, Random& r) {
    double* knob = r.chance(0.25) ? &fit.turn : &fit.shift[r.below(3)];
    auto error = [&](double x) {
        *knob = x;
        Truth t = judge(m, render(m, d, fit), d.din, COARSE);
        return t.reach <= 0 ? INF : (upper ? t.axis[axis].high.value : -t.axis[axis].low.value) - goal;
    };
    double x0 = 0, e0 = error(0), x1 = knob == &fit.turn ? 0.01 : 1, e1 = error(x1);
    for (int i = 0; i < 12; ++i) {
        if (e0 == INF || e1 == INF || std::fabs(e1 - e0) < 1e-9) return false;
        double x2 = x1 - e1 * (x1 - x0) / (e1 - e0);
        if (std::fabs(x2) > 1500) return false;
        x0 = x1, e0 = e1, x1 = x2, e1 = error(x2);
        if (std::fabs(e1) < 1e-7 * m.axes[axis].travel()) return true;
    }
    return false;
}

const Extreme& extreme_of(const AxisTruth& a, Target target) {
    return target == VELOCITY ? a.velocity : target == ACCELERATION ? a.acceleration : a.step;
}

/// Scales F by k and E by k² until the axis has `goal`. In DIN 66025 one step is exact, since this scales time; RS274 has
/// no E, so F is found step by step. Whole numbers come near the goal only.
bool fit_feed(const Machine& m, const Draft& d, Fit& fit, int axis, Target target, double goal) {
    double tolerance = d.round ? 0.05 : 1e-6;
    for (int i = 0; i < 30; ++i) {
        double value = extreme_of(judge(m, render(m, d, fit), d.din, COARSE).axis[axis], target).value;
        if (value < 1e-9) return false;
        double factor = goal / value;
        if (std::fabs(factor - 1) < tolerance) return true;
        fit.k *= target == ACCELERATION ? std::sqrt(factor) : factor;
        if (fit.k > 1e3 || fit.k < 1e-3 || d.acceleration * fit.k * fit.k > 1e8) return false;  // beyond what E may be
    }
    return false;
}

bool attempt(const Machine& m, Kind kind, Random& r, bool din, string& text, string& label, Truth& truth) {
    Draft draft;
    if (!make_draft(m, kind, din, draft, r)) return false;
    Fit fit;
    Target target = NO_TARGET;
    int axis = r.below(int(m.axes.size()));
    double factor = 1;
    if (kind == REACH) fit.k = r.between(0.5, 2);
    else {
        std::vector<double> targets = {VELOCITY, ACCELERATION};
        if (kind == JUNCTION) targets = {STEP, STEP, STEP, ACCELERATION};
        else if (kind != SINGULAR && m.axes[axis].limited()) targets.push_back(POSITION);
        target = Target(int(r.one_of(targets)));
        const Axis& a = m.axes[axis];
        if (target == POSITION) {
            bool upper = r.chance(0.5);
            factor = r.one_of({-0.05, -0.001, 0.001, 0.001, 0.01, 0.1, 1});  // beyond the limit, in travels
            if (!fit_position(m, draft, fit, axis, upper, upper ? a.max + factor * a.travel() : a.min - factor * a.travel(), r))
                return false;
        } else {
            factor = draft.round ? r.one_of({0.5, 1.1, 2, 11}) : r.one_of({0.5, 0.999, 1.001, 1.001, 1.01, 1.1, 2, 11});
            double limit = target == VELOCITY ? a.velocity : target == ACCELERATION ? a.acceleration : a.step;
            if (!fit_feed(m, draft, fit, axis, target, factor * limit)) return false;
        }
    }
    text = render(m, draft, fit);
    truth = judge(m, text, din, COARSE);
    if (truth.duration > (din ? 2.5 : 5)) return false;  // RS274 begins with a rapid from the machine's start
    if ((truth.reach <= 0) != (kind == REACH) && !(kind == REACH && truth.reach < 1)) return false;
    // A target on an axis that hardly moves would drive the others to absurd speeds.
    for (size_t i = 0; i < m.axes.size() && truth.reach > 0 && kind != SINGULAR; ++i)
        if (truth.axis[i].velocity.value > 30 * m.axes[i].velocity) return false;
    if (target != NO_TARGET) {
        const AxisTruth& a = truth.axis[axis];
        bool nearer_high = std::fabs(a.high.value - m.axes[axis].max) < std::fabs(-a.low.value - m.axes[axis].min);
        if (!in_place(kind, truth, target == POSITION ? (nearer_high ? a.high : a.low) : extreme_of(a, target))) return false;
    }
    truth = judge(m, text, din, FINE);
    label = string(KIND_NAMES[kind]) + " " + (target == NO_TARGET ? "" : m.axes[axis].name + "-") + TARGET_NAMES[target] + " " +
            number(factor);
    return true;
}

std::vector<Kind> kinds_of(const Machine& m) {
    std::vector<Kind> kinds = {ARC, SAMPLES, JUNCTION, INCREMENTAL, OFFSET, START, END};
    bool arms = m.kind == "scara2" || m.kind == "scara3";
    if (arms || m.kind == "gantry_cutter3") kinds.push_back(UNWRAPPING);
    if (arms || m.kind == "tripod") kinds.push_back(SINGULAR), kinds.push_back(REACH);
    return kinds;
}

void generate(const Machine& m, uint64_t seed, int first, int count, const string& folder) {
    std::vector<Kind> kinds = kinds_of(m);
    for (int i = first; i < first + count; ++i) {
        Kind kind = kinds[i % kinds.size()];
        uint64_t mixed = seed * 1000003 + uint64_t(i);
        for (char c : m.name) mixed = mixed * 31 + uint64_t(c);
        Random r{std::mt19937_64(mixed)};
        string text, label;
        // Near an edge of the reach the axes can do less than the caps of RS274: there only DIN 66025 states the motion.
        // Targets that need another acceleration than the cap are not met in RS274 either.
        bool rs274 = kind != SINGULAR && kind != REACH && r.chance(0.25), din = true, done = false;
        Truth truth;
        for (int tries = 0; tries < 3000 && !done; ++tries) {
            din = !rs274 || tries >= 40;
            done = attempt(m, kind, r, din, text, label, truth);
        }
        if (!done) {
            std::fprintf(stderr, "no program %d of kind %s\n", i, KIND_NAMES[kind]);
            std::exit(2);
        }
        char name[32];
        std::snprintf(name, sizeof name, "%05d.%s", i, din ? "cnc" : "ngc");
        std::ofstream(folder + "/" + name) << text;
        print(m, name, label, truth);
    }
}

int main(int argc, char** argv) {
    std::vector<string> args(argv + 1, argv + argc);
    if (args.size() == 6 && args[0] == "generate") {
        generate(read_machine(args[1]), std::stoull(args[2]), std::stoi(args[3]), std::stoi(args[4]), args[5]);
    } else if (args.size() == 3 && args[0] == "judge") {
        Machine machine = read_machine(args[1]);
        std::ifstream in(args[2]);
        string text((std::istreambuf_iterator<char>(in)), {});
        bool din = args[2].size() > 4 && args[2].substr(args[2].size() - 4) == ".cnc";
        print(machine, args[2], "judged - 0", judge(machine, text, din, FINE));
    } else {
        std::fprintf(stderr, "truth generate MACHINE SEED FIRST COUNT FOLDER | truth judge MACHINE PROGRAM\n");
        return 2;
    }
}
