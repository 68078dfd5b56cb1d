#include "sim/machine.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/rig_run.h"

namespace axisfit {
namespace {

/// How an arm moves, at all instants.
struct Course {
  std::vector<double> position, velocity;

  explicit Course(std::size_t instants) : position(instants, 0.0), velocity(instants, 0.0) {}
};

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double x : values) most = std::max(most, std::abs(x));
  return most;
}

/// By how much a differs from b, of the range of b.
double change_of(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  const double range = largest(b);
  return range > 0.0 ? most / range : most > 0.0 ? 1.0 : 0.0;
}

/// The axes, as each of them sees the others.
class Together {
 public:
  Together(const std::vector<CoupledAxis>& axes, const RecordingOptions& options,
           const Relaxation& relaxation)
      : axes_(axes), options_(options), instants_(instants_for(options, relaxation)) {
    courses_.assign(axes.size(), Course(instants_.size()));
  }

  /// Simulates every axis once; returns the largest change.
  double sweep() {
    double change = 0.0;
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      Course course(instants_.size());
      const std::vector<ChannelSeries> channels = channels_of(a);
      run_rig(axes_[a].rig, axes_[a].motion, options_, instants_, channels,
              [&](std::size_t i, const Integrator<double>& axis) {
                course.position[i] = axis.state()[0];
                course.velocity[i] = axis.state()[1];
              });
      change = std::max({change, change_of(courses_[a].position, course.position),
                         change_of(courses_[a].velocity, course.velocity)});
      courses_[a] = std::move(course);
    }
    return change;
  }

  std::vector<Column> record(std::size_t axis, const std::vector<Signal>& signals) const {
    const std::vector<ChannelSeries> channels = channels_of(axis);
    RecordingOptions options = options_;
    options.signals = signals;
    options.seed += axis;
    std::vector<Column> columns =
        axisfit::record(axes_[axis].rig, axes_[axis].motion, options, {instants_, channels});
    const std::size_t intervals = std::max<std::size_t>(1, columns.front().values.size() - 1);
    const std::size_t stride = std::max<std::size_t>(1, (instants_.size() - 1) / intervals);
    for (std::size_t j = 0; j < channels.size(); ++j) {
      const Channel& channel = (*axes_[axis].rig.model.structure.channels)[j];
      Column& column = columns.emplace_back(Column{column_name(channel.name, channel.unit), {}});
      for (std::size_t i = 0; i < instants_.size(); i += stride)
        column.values.push_back(channels[j].values[i] + channel.zero);
    }
    return columns;
  }

 private:
  /// The samples, divided as instruments with lags divide them, and further.
  static std::vector<double> instants_for(const RecordingOptions& options,
                                          const Relaxation& relaxation) {
    const double parts =
        4.0 * std::max(1.0, std::ceil(0.25 / (options.rate * relaxation.interval) - 1e-9));
    return sampling_times(options, parts);
  }

  /// At the instants; of a second derivative the first.
  static std::vector<double> values_of(const Course& course, const Motional& what) {
    using enum Motional::Of;
    const bool is_rate = what.derivative > 0;
    if (what.of == position) return is_rate ? course.velocity : course.position;
    std::vector<double> values;
    for (std::size_t i = 0; i < course.position.size(); ++i) {
      const double sin = std::sin(course.position[i]), cos = std::cos(course.position[i]);
      const double value = what.of == sine ? sin : cos, slope = what.of == sine ? cos : -sin;
      values.push_back(is_rate ? slope * course.velocity[i] : value);
    }
    return values;
  }

  std::vector<ChannelSeries> channels_of(std::size_t axis) const {
    std::vector<ChannelSeries> channels;
    for (std::size_t j = 0; j < axes_[axis].sources.size(); ++j) {
      const ChannelSource& source = axes_[axis].sources[j];
      ChannelSeries series;
      if (!source.axis) {
        series.values.assign(instants_.size(), 0.0);
        channels.push_back(std::move(series));
        continue;
      }
      series.values = values_of(courses_[*source.axis], source.what);
      if (source.what.derivative == 2) {
        // An acceleration jumps. Its mean from one instant to the next is exact in what it gives to
        // the axis.
        series.hold = Hold::zero_order;
        for (std::size_t i = 0; i + 1 < instants_.size(); ++i)
          series.values[i] =
              (series.values[i + 1] - series.values[i]) / (instants_[i + 1] - instants_[i]);
        if (instants_.size() > 1) series.values.back() = series.values[instants_.size() - 2];
      }
      const double zero = (*axes_[axis].rig.model.structure.channels)[j].zero;
      for (double& x : series.values) x = source.per_si * x - zero;
      channels.push_back(std::move(series));
    }
    return channels;
  }

  const std::vector<CoupledAxis>& axes_;
  const RecordingOptions& options_;
  std::vector<double> instants_;
  std::vector<Course> courses_;
};

}  // namespace

MachineRecording record_machine(const std::vector<CoupledAxis>& axes,
                                const std::vector<std::vector<Signal>>& signals,
                                const RecordingOptions& options, const Relaxation& relaxation) {
  Together together(axes, options, relaxation);
  MachineRecording recording;
  do {
    if (recording.sweeps == relaxation.most_sweeps)
      throw std::runtime_error(
          "the axes do not settle on a common motion: after " + std::to_string(recording.sweeps) +
          " simulations of each it still changes by " + std::to_string(100.0 * recording.change) +
          " % of its range; their couplings are too strong for this method");
    recording.change = together.sweep();
    ++recording.sweeps;
  } while (recording.change > relaxation.tolerance);
  for (std::size_t a = 0; a < axes.size(); ++a)
    recording.axes.push_back(together.record(a, signals[a]));
  return recording;
}

}  // namespace axisfit
