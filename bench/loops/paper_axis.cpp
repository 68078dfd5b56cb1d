// paper_axis [NAME=VALUE...] < COMMANDS > READINGS: the axis of Nelson and Chang (docs/model.md)
// with effects that its axis file does not declare. COMMANDS are the set-velocity voltages, one
// every 5 ms. READINGS are rows of time, command, velocity and acceleration, at 1 kHz and without
// noise.
//
// It shares no code and no method with the project's simulator: steps of 2 us, without events. The
// electric half of the axis takes half a step by the trapezoidal rule, the mechanical half a whole
// one, the electric half the rest (Strang). The mechanical half is the time stepping of Moreau and
// Jean: the positions are those of the middle, the velocities follow from the midpoint rule, and
// dry friction is the set-valued law itself, solved for the velocity at the end of the step. So an
// arm that sticks has a velocity of exactly zero.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <numbers>
#include <string>
#include <vector>

namespace {

constexpr double kStep = 2e-6;  // s
constexpr long kStepsOfReading = 500, kStepsOfCommand = 2500;

struct Axis {
  // The paper's x axis, in SI units.
  double R = 0.56, L = 2.35e-3, K_e = 0.289, K_m = 0.289, J_m = 8.47e-4, B_m = 7.33e-4;
  double K_t = 0.0668, r_g = 5.73e-3, H = 1e-5, M = 146.0, T_z = 7.05e-3, T_p = 0.04;
  double T_r = 1.59e-4, K_1 = 1014.2, K_2 = 870.0, K_i = 3.0, V_s = 95.0, V_L = 2.7;
  double B_a = 200.0, b_g = 1500.0, k_g = 5e6, F_s = 30.0, w = 2e-3, K_v = 1000.0;
  // What may act besides; absent unless it is given.
  double coulomb = 0.0, direction = 0.0;                    // N: dry friction, and +- by direction
  double stribeck = 0.0, stribeck_speed = 1.0;              // N, m/s
  double bump = 0.0, bump_at = 0.0, bump_width = 1.0;       // N, m, m
  double drag = 0.0, offset = 0.0, spring = 0.0;            // N s^2/m^2, N, N/m
  double ripple = 0.0, period = 1.0, phase = 0.0;           // N, m, rad: force along the stroke
  double payload = 0.0;                                     // kg
  double swing = 0.0, swing_hz = 1.0, swing_damping = 0.0;  // kg: part of the arm on a spring
  double torque_ripple = 0.0, order = 1.0;                  // share of the torque; waves in 1 rad
  double fade = 0.0, fade_time = 1.0;                       // share of the torque, s
  double pulse = 0.0, pulse_at = 0.0, pulse_length = 1.0;   // N, s, s
  double dead_time = 0.0, lag = 0.0;  // s: of the command, of the accelerometer
  double bias = 0.0, gain = 1.0;      // of the accelerometer
};

const std::map<std::string, double Axis::*> kNames = {
    {"V_L", &Axis::V_L},
    {"B_a", &Axis::B_a},
    {"b_g", &Axis::b_g},
    {"k_g", &Axis::k_g},
    {"T_p", &Axis::T_p},
    {"coulomb", &Axis::coulomb},
    {"direction", &Axis::direction},
    {"stribeck", &Axis::stribeck},
    {"stribeck_speed", &Axis::stribeck_speed},
    {"bump", &Axis::bump},
    {"bump_at", &Axis::bump_at},
    {"bump_width", &Axis::bump_width},
    {"drag", &Axis::drag},
    {"offset", &Axis::offset},
    {"spring", &Axis::spring},
    {"ripple", &Axis::ripple},
    {"period", &Axis::period},
    {"phase", &Axis::phase},
    {"payload", &Axis::payload},
    {"swing", &Axis::swing},
    {"swing_hz", &Axis::swing_hz},
    {"swing_damping", &Axis::swing_damping},
    {"torque_ripple", &Axis::torque_ripple},
    {"order", &Axis::order},
    {"fade", &Axis::fade},
    {"fade_time", &Axis::fade_time},
    {"pulse", &Axis::pulse},
    {"pulse_at", &Axis::pulse_at},
    {"pulse_length", &Axis::pulse_length},
    {"dead_time", &Axis::dead_time},
    {"lag", &Axis::lag},
    {"bias", &Axis::bias},
    {"gain", &Axis::gain},
};

struct State {
  double y0 = 0.0, y1 = 0.0, y2 = 0.0, y3 = 0.0, y4 = 0.0, y5 = 0.0, y6 = 0.0;
  double place = 0.0, speed = 0.0;  // of the part that swings, m, m/s
};

double limited(double x, double limit) { return std::clamp(x, -limit, limit); }

/// Preamplifier and current over a time h, at a constant speed of the motor.
void step_electric(const Axis& p, double command, double h, State& y) {
  const double a = 0.5 * h, product = p.T_p * p.T_r, sum = p.T_p + p.T_r;
  const double input = p.K_1 * command - p.K_2 * p.K_t * y.y3;
  const double V_c = limited(y.y4 + p.T_z * y.y5, p.V_L);
  const double y5 = (y.y5 + a / product * (2.0 * (input - y.y4) - (sum + a) * y.y5)) /
                    (1.0 + a / product * (sum + a));
  y.y4 += a * (y.y5 + y5);
  y.y5 = y5;
  const double next_V_c = limited(y.y4 + p.T_z * y.y5, p.V_L);
  const double V_m = limited(p.K_v * (V_c - y.y6 / p.K_i), p.V_s), c = a / p.L;
  const double known = y.y6 + c * (V_m - p.R * y.y6 - 2.0 * p.K_e * y.y3);
  // The current is the only unknown of an equation that rises with it: at most one case holds.
  y.y6 = (known + c * p.K_v * next_V_c) / (1.0 + c * (p.R + p.K_v / p.K_i));
  const double next_V_m = p.K_v * (next_V_c - y.y6 / p.K_i);
  if (std::abs(next_V_m) > p.V_s)
    y.y6 = (known + c * std::copysign(p.V_s, next_V_m)) / (1.0 + c * p.R);
}

/// Level of dry friction in the direction of the force that moves or would move the arm.
double dry_friction(const Axis& p, const State& y, double position, double force) {
  const double speed = std::abs(y.y1);
  double level = p.coulomb + std::copysign(p.direction, force) + (speed < p.w ? p.F_s : 0.0);
  if (p.stribeck != 0.0) level += p.stribeck * std::exp(-speed / p.stribeck_speed);
  if (p.bump != 0.0)
    level += p.bump * std::exp(-std::pow((position - p.bump_at) / p.bump_width, 2));
  return level;
}

double force_on_arm(const Axis& p, const State& y, double position, double time) {
  double force = p.offset - p.spring * position - p.drag * y.y1 * std::abs(y.y1);
  const double turn = 2.0 * std::numbers::pi;
  if (p.ripple != 0.0) force += p.ripple * std::sin(turn * position / p.period + p.phase);
  if (const double s = (time - p.pulse_at) / p.pulse_length; p.pulse != 0.0 && s > 0.0 && s < 1.0)
    force += p.pulse * 0.5 * (1.0 - std::cos(turn * s));
  return force;
}

double motor_torque(const Axis& p, const State& y, double angle, double time) {
  double share = 1.0;
  if (p.torque_ripple != 0.0) share += p.torque_ripple * std::sin(p.order * angle + p.phase);
  // Magnets lose in proportion to their temperature, which settles.
  if (p.fade != 0.0) share *= 1.0 + p.fade * std::expm1(-time / p.fade_time);
  return p.K_m * y.y6 * share;
}

/// Arm, motor and what swings, over one step from `time` on.
void step_mechanical(const Axis& p, double time, State& y) {
  const double h = kStep, a = 0.5 * h, r = p.r_g;
  const double position = y.y0 + a * y.y1, angle = y.y2 + a * y.y3, middle = time + a;
  const double x = r * angle - position, beyond = x - limited(x, p.H);
  const double teeth = p.k_g * beyond, b = beyond != 0.0 ? 0.5 * p.b_g : 0.0;
  double force = force_on_arm(p, y, position, middle);
  if (p.swing != 0.0) {
    const double turns = 2.0 * std::numbers::pi * p.swing_hz;
    const double back =
        p.swing * turns *
        (turns * (position - y.place - a * y.speed) + 2.0 * p.swing_damping * (y.y1 - y.speed));
    const double speed = y.speed + h * back / p.swing;
    y.place += a * (y.speed + speed);
    y.speed = speed;
    force -= back;
  }
  // The motor's next speed is of + per y1'; that of the arm then has one equation.
  const double inertia = p.J_m / h + 0.5 * p.B_m + r * r * b;
  const double of = ((p.J_m / h - 0.5 * p.B_m) * y.y3 + motor_torque(p, y, angle, middle) -
                     r * (teeth + b * (r * y.y3 - y.y1))) /
                    inertia;
  const double per = r * b / inertia, mass = (p.M + p.payload - p.swing) / h;
  const double push = (mass - 0.5 * p.B_a) * y.y1 + teeth + b * (r * (y.y3 + of) - y.y1) + force;
  const double held = dry_friction(p, y, position, push);
  const double slides = std::max(std::abs(push) - held, 0.0);
  const double y1 = std::copysign(slides, push) / (mass + 0.5 * p.B_a + b * (1.0 - r * per));
  const double y3 = of + per * y1;
  y.y0 += a * (y.y1 + y1);
  y.y2 += a * (y.y3 + y3);
  y.y1 = y1;
  y.y3 = y3;
}

}  // namespace

int main(int count, char** arguments) {
  Axis axis;
  for (int k = 1; k < count; ++k) {
    const std::string text = arguments[k];
    const auto equals = text.find('=');
    const auto name = kNames.find(text.substr(0, equals));
    if (equals == std::string::npos || name == kNames.end()) {
      std::cerr << "unknown: " << text << '\n';
      return 2;
    }
    axis.*name->second = std::stod(text.substr(equals + 1));
  }
  std::vector<double> commands;
  for (double command = 0.0; std::cin >> command;) commands.push_back(command);
  const long steps = static_cast<long>(commands.size()) * kStepsOfCommand;
  const long late = std::lround(axis.dead_time / kStep);
  const double follows = axis.lag > 0.0 ? -std::expm1(-kStep / axis.lag) : 1.0;
  State y;
  double acceleration = 0.0;
  for (long k = 0; k < steps; ++k) {
    const double time = static_cast<double>(k) * kStep;
    // A reading at the instant of a switch is of before the switch.
    if (k % kStepsOfReading == 0)
      std::printf("%.3f %.9g %.9g %.9g\n", time, commands[k / kStepsOfCommand], y.y1,
                  axis.gain * acceleration + axis.bias);
    const double command = k < late ? 0.0 : commands[(k - late) / kStepsOfCommand];
    const double before = y.y1;
    step_electric(axis, command, 0.5 * kStep, y);
    step_mechanical(axis, time, y);
    step_electric(axis, command, 0.5 * kStep, y);
    acceleration += follows * ((y.y1 - before) / kStep - acceleration);
  }
  return std::isfinite(y.y0) ? 0 : 1;
}
