#include "fit/search/force_response.h"

#include <complex>

namespace axisfit {
namespace {

/// One step of a rigid axis of unit mass that tracks the data by the observer, by the implicit
/// midpoint rule, stable however high the observer gain: of (position, velocity), and what a force
/// adds to them.
struct Step {
  Eigen::Matrix2d state;
  Eigen::Vector2d force;
};

Step step_of(const Observer& observer, double h) {
  const double a = 0.5 * h * observer.position, b = 0.5 * h * observer.velocity,
               c = 0.5 * h * observer.acceleration;
  Eigen::Matrix2d inverse, explicit_half;
  inverse << 1.0 + b, 0.5 * h, -c, 1.0 + a;
  inverse /= (1.0 + a) * (1.0 + b) + 0.5 * h * c;
  explicit_half << 1.0 - a, 0.5 * h, -c, 1.0 - b;
  return {inverse * explicit_half, inverse * Eigen::Vector2d(0.0, h)};
}

/// Calls visit(row, measurement, sample) for the residuals of a recording.
template <class Visit>
void visit_rows(const Recording& recording, Visit&& visit) {
  Eigen::Index row = 0;
  for (const Measurement& m : recording.measurements)
    for (std::size_t i = 0; m.fitted && i < recording.times.size(); ++i)
      if (recording.fits(m, i)) visit(row++, m, i);
}

}  // namespace

template <class T>
Eigen::VectorX<T> response_to(const Recording& recording, const std::vector<T>& force,
                              const Observer& observer) {
  const std::size_t n = recording.times.size();
  std::vector<Eigen::Vector2<T>> states(n, Eigen::Vector2<T>::Zero());
  for (std::size_t i = 0; i + 1 < n; ++i) {
    const Step step = step_of(observer, recording.times[i + 1] - recording.times[i]);
    states[i + 1] =
        step.state.cast<T>() * states[i] + step.force.cast<T>() * (0.5 * (force[i] + force[i + 1]));
  }
  Eigen::Index rows = 0;
  visit_rows(recording, [&](Eigen::Index, const Measurement&, std::size_t) { ++rows; });
  Eigen::VectorX<T> shown(rows);
  visit_rows(recording, [&](Eigen::Index row, const Measurement& m, std::size_t i) {
    const T x = m.signal == Signal::position       ? states[i][0]
                : m.signal == Signal::acceleration ? force[i]
                : m.signal == Signal::velocity     ? states[i][1]
                                                   : T(0.0);
    shown[row] = x / m.sigma;
  });
  return shown;
}

template Eigen::VectorX<double> response_to(const Recording&, const std::vector<double>&,
                                            const Observer&);
template Eigen::VectorX<std::complex<double>> response_to(const Recording&,
                                                          const std::vector<std::complex<double>>&,
                                                          const Observer&);

std::vector<double> adjoint_response(const Recording& recording, const Eigen::VectorXd& rows,
                                     const Observer& observer) {
  const std::size_t n = recording.times.size();
  std::vector<Eigen::Vector2d> shown(n, Eigen::Vector2d::Zero());
  std::vector<double> g(n, 0.0);
  visit_rows(recording, [&](Eigen::Index row, const Measurement& m, std::size_t i) {
    const double x = rows[row] / m.sigma;
    if (m.signal == Signal::position) shown[i][0] += x;
    if (m.signal == Signal::velocity) shown[i][1] += x;
    if (m.signal == Signal::acceleration) g[i] += x;
  });
  Eigen::Vector2d carried = Eigen::Vector2d::Zero();
  for (std::size_t i = n - 1; i > 0; --i) {
    carried += shown[i];
    const Step step = step_of(observer, recording.times[i] - recording.times[i - 1]);
    const double half = 0.5 * step.force.dot(carried);
    g[i] += half;
    g[i - 1] += half;
    carried = step.state.transpose() * carried;
  }
  return g;
}

}  // namespace axisfit
