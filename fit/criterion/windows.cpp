#include "fit/criterion/windows.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fit/data/initial_state.h"

namespace axisfit {
namespace {

using Eigen::Index;
using Eigen::Matrix2d;
using Eigen::Vector2d;

/// Samples on either side of a start that tell the state there.
constexpr std::size_t kAround = 10;
/// How far a state may be from what they tell, in its standard errors.
constexpr double kErrors = 30.0;

bool estimates_initial_state(const Job& job, std::size_t recording) {
  return std::ranges::any_of(job.free, [&](const FreeParameter& p) {
    return job.entry(p.quantity).group == "initial" && p.recording.value_or(recording) == recording;
  });
}

/// The state at a sample, from the samples around it.
WindowStart start_at(const Recording& recording, std::size_t sample) {
  WindowStart start{.sample = sample};
  const std::size_t first = sample - std::min(sample, kAround);
  const std::size_t count = std::min(2 * kAround + 1, recording.times.size() - first);
  const auto around = [&](const Measurement& m) {
    return sample == 0 ? first_course(recording.times, m.values, recording.initial_samples, m.sigma)
                       : local_course(recording.times, m.values, first, count, sample, m.sigma);
  };
  if (const Measurement* position = recording.find(Signal::position)) {
    const LocalCourse course = around(*position);
    start.position = course.value;
    start.position_deviation = kErrors * course.value_error;
    start.velocity = course.slope;
    start.velocity_deviation = kErrors * course.slope_error;
  }
  if (const Measurement* velocity = recording.find(Signal::velocity)) {
    const LocalCourse course = around(*velocity);
    start.velocity = course.value;
    start.velocity_deviation = kErrors * course.value_error;
  }
  return start;
}

}  // namespace

Partition windows_of(const Recording& recording, double length) {
  constexpr std::size_t kFewest = 10;
  const std::size_t samples = recording.times.size();
  const double duration = recording.times.back() - recording.times.front();
  const auto most = static_cast<double>(std::max<std::size_t>(1, samples / kFewest));
  const auto windows =
      static_cast<std::size_t>(std::clamp(std::round(duration / length), 1.0, most));
  return {samples, windows};
}

std::vector<WindowStart> window_starts(const Job& job, std::size_t index) {
  const Recording& recording = job.recordings[index];
  std::vector<WindowStart> starts;
  // The model's own state, from which it begins, may be known.
  const bool knows_start =
      recording.initial_state == InitialState::given || estimates_initial_state(job, index);
  const double length = std::holds_alternative<FreeRun>(job.options.criterion) && !knows_start
                            ? std::numeric_limits<double>::infinity()
                            : window_length(job.options.criterion);
  if (!(length > 0.0) || recording.command.meaning == Meaning::reference ||
      (recording.find(Signal::position) == nullptr && recording.find(Signal::velocity) == nullptr))
    return starts;
  const Partition windows = windows_of(recording, length);
  for (std::size_t k = 0; k < windows.parts(); ++k)
    starts.push_back(start_at(recording, windows.first(k)));
  if (knows_start || recording.knows_position) starts.front().position = {};
  if (knows_start || recording.knows_velocity) starts.front().velocity = {};
  return starts;
}

std::size_t window_states(const Job& job) {
  std::size_t states = 0;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    if (job.recordings[r].role == Role::fit)
      for (const WindowStart& start : window_starts(job, r))
        states += (start.position ? 1 : 0) + (start.velocity ? 1 : 0);
  return states;
}

WindowStates::WindowStates(std::vector<WindowStart> starts, std::vector<std::size_t> window_of)
    : starts_(std::move(starts)), window_of_(std::move(window_of)) {
  for (const WindowStart& start : starts_) {
    const Vector2d nominal(start.position.value_or(0.0), start.velocity.value_or(0.0));
    const Vector2d deviation(start.position_deviation, start.velocity_deviation);
    windows_.push_back({nominal, nominal, Vector2d::Zero(), deviation.cwiseAbs2().cwiseInverse(),
                        std::numeric_limits<double>::infinity()});
  }
}

void WindowStates::set_start(std::size_t window, const Vector2d& state) {
  WindowStart& start = starts_[window];
  if (start.position) start.position = state[0];
  if (start.velocity) start.velocity = state[1];
}

bool WindowStates::improve(const Eigen::VectorXd& residuals, const Columns& derivatives) {
  std::vector<Matrix2d> normal(windows_.size(), Matrix2d::Zero());
  std::vector<Vector2d> gradient(windows_.size(), Vector2d::Zero());
  std::vector<double> cost(windows_.size(), 0.0);
  for (Index row = 0; row < residuals.size(); ++row) {
    const std::size_t k = window_of_[static_cast<std::size_t>(row)];
    const Vector2d d = derivatives.row(row).transpose();
    normal[k] += d * d.transpose();
    gradient[k] += d * residuals[row];
    cost[k] += residuals[row] * residuals[row];
  }
  const bool started = passes_++ > 0;
  if (!started) derivatives_ = derivatives;
  std::vector<bool> is_better(windows_.size());
  double all = 0.0, promised = 0.0;
  for (std::size_t k = 0; k < windows_.size(); ++k) {
    Window& window = windows_[k];
    const Vector2d tried = started ? Vector2d(window.best + window.step) : window.best;
    const Vector2d away = tried - window.nominal;
    const double here = cost[k] + away.dot(window.weight.cwiseProduct(away));
    is_better[k] = here < window.cost;
    if (is_better[k]) {
      window.best = tried;
      window.cost = here;
      const Matrix2d n = normal[k] + Matrix2d(window.weight.asDiagonal());
      window.step = -n.ldlt().solve(gradient[k] + window.weight.cwiseProduct(away));
      window.promise = window.step.dot(n * window.step);
    } else {
      window.step *= 0.5;
      window.promise *= 0.5;
    }
    all += window.cost;
    promised += window.promise;
  }
  for (Index row = 0; row < residuals.size(); ++row)
    if (is_better[window_of_[static_cast<std::size_t>(row)]])
      derivatives_.row(row) = derivatives.row(row);
  constexpr double kNothing = 1e-10;
  constexpr int kMostPasses = 10;
  const bool goes_on = promised > kNothing * all && passes_ < kMostPasses;
  for (std::size_t k = 0; k < windows_.size(); ++k)
    set_start(k, goes_on ? Vector2d(windows_[k].best + windows_[k].step) : windows_[k].best);
  return goes_on;
}

void WindowStates::eliminate_from(
    Eigen::Ref<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> columns)
    const {
  if (windows_.empty()) return;
  using Products = Eigen::Matrix<double, kStates, Eigen::Dynamic>;
  std::vector<Matrix2d> normal;
  for (const Window& window : windows_) normal.emplace_back(window.weight.asDiagonal());
  std::vector<Products> products(windows_.size(), Products::Zero(kStates, columns.cols()));
  for (Index row = 0; row < columns.rows(); ++row) {
    const std::size_t k = window_of_[static_cast<std::size_t>(row)];
    const Vector2d d = derivatives_.row(row).transpose();
    normal[k] += d * d.transpose();
    products[k] += d * columns.row(row);
  }
  for (std::size_t k = 0; k < windows_.size(); ++k)
    products[k] = normal[k].ldlt().solve(products[k]).eval();
  for (Index row = 0; row < columns.rows(); ++row)
    columns.row(row) -= derivatives_.row(row) * products[window_of_[static_cast<std::size_t>(row)]];
}

}  // namespace axisfit
