// speed [REPEATS]: the time of one residual with its Jacobian, for 1, 5, 10 and 20 parameters, by
// axisfit, by its finite differences, by SUNDIALS CVODES and by Boost.odeint, with the errors of
// the states and their sensitivities beside it (README.md in this folder).
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <functional>

#include "bench/speed/cvodes.h"
#include "bench/speed/evaluation.h"
#include "bench/speed/odeint.h"

namespace {

using namespace axisfit;
using namespace axisfit::speed;

int repeats = 5;

/// ms of processor time, the least of several runs.
double time_of(const std::function<void()>& work) {
  double least = 1e300;
  for (int i = 0; i < repeats; ++i) {
    const std::clock_t begin = std::clock();
    work();
    least = std::min(least, 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return least;
}

template <int N>
Trajectory by_axisfit(const Work& work) {
  Trajectory trajectory;
  trajectory.parameters = N;
  simulate<Jet<N>>(
      work.model<N>(), Schedule{{-1.0}, {work.command}}, work.times,
      [&](std::size_t, const Integrator<Jet<N>>& axis) { trajectory.add<N>(axis.state()); });
  return trajectory;
}

/// One-sided differences of our own simulation.
template <int N>
Trajectory by_differences(const Work& work) {
  constexpr double kStep = 1e-6;  // relative
  const auto states = [&](int parameter) {
    Model<double> model = work.rig.model;
    if (parameter >= 0)
      *members(model)[quantity_index(kParameters[static_cast<std::size_t>(parameter)])] *=
          1.0 + kStep;
    std::vector<double> values;
    simulate<double>(model, Schedule{{-1.0}, {work.command}}, work.times,
                     [&](std::size_t, const Integrator<double>& axis) {
                       values.insert(values.end(), axis.state().begin(),
                                     axis.state().begin() + kPaperStates);
                     });
    return values;
  };
  Trajectory trajectory;
  trajectory.parameters = N;
  trajectory.states = states(-1);
  trajectory.sensitivities.resize(trajectory.states.size() * N);
  for (int k = 0; k < N; ++k) {
    const std::vector<double> moved = states(k);
    for (std::size_t i = 0; i < moved.size(); ++i)
      trajectory.sensitivities[i * N + static_cast<std::size_t>(k)] =
          (moved[i] - trajectory.states[i]) / kStep;
  }
  return trajectory;
}

template <int N>
void compare(const Work& work) {
  const Scales scales = scales_of(by_axisfit<N>(work));
  const Trajectory reference = by_odeint<N>(work, scales, 1e-12);
  double ours = 0.0;
  const auto row = [&](const std::string& name, double ms, const Error& error) {
    fmt::print("{:>3}  {:<44} {:>9.3f} {:>8.1f} {:>9.1e} {:>9.1e}\n", N, name, ms, ms / ours,
               error.states, error.sensitivities);
  };
  Evaluation evaluation(work.rig, N, work.times.back());
  ours = time_of([&] { evaluation.run(); });
  row("axisfit", ours, error_of(by_axisfit<N>(work), reference));
  const auto other = [&](const std::string& name, const std::function<Trajectory()>& run) {
    Trajectory found;
    const double ms = time_of([&] { found = run(); });
    row(name, ms, error_of(found, reference));
  };
  other("finite differences of axisfit", [&] { return by_differences<N>(work); });
  for (const bool supplied : {true, false})
    for (const bool simultaneous : {false, true})
      for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
        // With its own quotients CVODES does not get further, but takes minutes to find out.
        if (!supplied && tolerance < 1e-6) continue;
        other(fmt::format("CVODES, {}, {}, {:g}", supplied ? "supplied" : "quotients",
                          simultaneous ? "simultaneous" : "staggered", tolerance),
              [&] {
                return by_cvodes<N>(work, scales, {tolerance, supplied, simultaneous});
              });
      }
  for (const double tolerance : {1e-4, 1e-6, 1e-8})
    other(fmt::format("odeint, Dormand-Prince, {:g}", tolerance),
          [&] { return by_odeint<N>(work, scales, tolerance); });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2) {
    fmt::print(stderr, "usage: speed [REPEATS]\n");
    return 2;
  }
  if (argc == 2) repeats = std::max(1, std::atoi(argv[1]));
  Work work;
  work.rig = x_axis();
  for (int i = 0; i <= 2500; ++i) work.times.push_back(i * 1e-3);
  fmt::print("{:>3}  {:<44} {:>9} {:>8} {:>9} {:>9}\n", "n", "method", "ms", "times", "states",
             "sens.");
  compare<1>(work);
  compare<5>(work);
  compare<10>(work);
  compare<20>(work);
  return 0;
}
