#include "bench/speed/odeint.h"

#include <boost/numeric/odeint.hpp>
#include <cmath>

namespace axisfit::speed {
namespace {

/// States and sensitivities in units of their scales, so that one tolerance serves all.
template <int N>
using Scaled = std::array<double, kPaperStates*(1 + N)>;

}  // namespace

template <int N>
Trajectory by_odeint(const Work& work, const Scales& scales, double tolerance) {
  namespace odeint = boost::numeric::odeint;
  Axis<N> axis(work);
  const auto to_scaled = [&](const State<Jet<N>>& y) {
    Scaled<N> x;
    for (std::size_t i = 0; i < kPaperStates; ++i) {
      x[i] = y[i].a / scales.states[i];
      for (std::size_t k = 0; k < N; ++k)
        x[kPaperStates + i * N + k] =
            y[i].v[static_cast<Eigen::Index>(k)] / scales.sensitivities[i * N + k];
    }
    return x;
  };
  const auto from_scaled = [&](const Scaled<N>& x) {
    State<Jet<N>> y{};
    for (std::size_t i = 0; i < kPaperStates; ++i) {
      y[i].a = x[i] * scales.states[i];
      for (std::size_t k = 0; k < N; ++k)
        y[i].v[static_cast<Eigen::Index>(k)] =
            x[kPaperStates + i * N + k] * scales.sensitivities[i * N + k];
    }
    return y;
  };
  const auto plain = [&](const Scaled<N>& x) {
    State<double> y{};
    for (std::size_t i = 0; i < kPaperStates; ++i) y[i] = x[i] * scales.states[i];
    return y;
  };
  const auto rate = [&](const Scaled<N>& x, Scaled<N>& derivative, double) {
    derivative = to_scaled(axis.rate(from_scaled(x)));
  };
  auto stepper = odeint::make_dense_output(
      tolerance, tolerance,
      odeint::runge_kutta_dopri5<Scaled<N>, double, Scaled<N>, double, odeint::array_algebra>());
  Trajectory trajectory;
  trajectory.parameters = N;
  stepper.initialize(to_scaled(axis.start()), 0.0, 1e-7);
  std::size_t next = 0;
  const auto show_until = [&](double end) {
    Scaled<N> x;
    for (; next < work.times.size() && work.times[next] <= end; ++next) {
      stepper.calc_state(work.times[next], x);
      trajectory.template add<N>(from_scaled(x));
    }
  };
  trajectory.template add<N>(axis.start());
  ++next;
  while (next < work.times.size()) {
    const auto [start, end] = stepper.do_step(rate);
    int met = -1;
    double first = end;
    Scaled<N> x;
    axis.visit_guards(plain(stepper.current_state()), [&](int guard, double g) {
      if (g >= 0.0) return;
      const auto value = [&](double t) {
        stepper.calc_state(t, x);
        double at = 0.0;
        axis.visit_guards(plain(x), [&](int i, double v) {
          if (i == guard) at = v;
        });
        return at;
      };
      if (value(start) < 0.0) return;  // rounding, behind an event
      double low = start, high = end;
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (value(middle) < 0.0 ? high : low) = middle;
      }
      if (met < 0 || high < first) met = guard, first = high;
    });
    if (met < 0) {
      show_until(end);
      continue;
    }
    show_until(first);
    stepper.calc_state(first, x);
    const State<Jet<N>> passed = axis.pass(met, from_scaled(x));
    stepper.initialize(to_scaled(passed), first, 1e-7);
  }
  return trajectory;
}

template Trajectory by_odeint<1>(const Work&, const Scales&, double);
template Trajectory by_odeint<5>(const Work&, const Scales&, double);
template Trajectory by_odeint<10>(const Work&, const Scales&, double);
template Trajectory by_odeint<20>(const Work&, const Scales&, double);

}  // namespace axisfit::speed
