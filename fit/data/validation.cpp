#include "fit/data/validation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "base/units.h"
#include "sim/sampling.h"

namespace axisfit {
namespace {

using Rule = JobFault::Rule;

/// "0.56 ohm", for messages.
std::string rounded(double value, std::string_view unit) {
  return with_unit(fmt::format("{:g}", value), unit);
}

bool finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
}

bool within(double value, const Quantity& range) {
  return range.lower <= value && value <= range.upper;
}

/// Whether this is part of the state with which a recording begins, which may be anywhere.
bool is_state(const QuantityEntry& entry) { return entry.group == "initial"; }

class JobCheck {
 public:
  explicit JobCheck(const Job& job) : job_(job), quantities_(quantity_list(job.vocabulary())) {}

  std::vector<JobFault> run() && {
    for (std::size_t r = 0; r < job_.recordings.size(); ++r) {
      subject_ = {.recording = r};
      check_recording(job_.recordings[r], r);
    }
    for (std::size_t p = 0; p < job_.free.size(); ++p) {
      subject_ = {.parameter = p};
      check_parameter(job_.free[p], p);
    }
    subject_ = {};
    check_options();
    check_model();
    check_extent();
    return std::move(found_);
  }

 private:
  struct Subject {
    std::optional<std::size_t> recording{}, measurement{}, parameter{};
  };

  void add(Rule rule, std::string message) {
    found_.push_back(
        {rule, std::move(message), subject_.recording, subject_.measurement, subject_.parameter});
  }

  // ---- A recording ----

  void check_recording(const Recording& r, std::size_t index) {
    const std::size_t faults_before = found_.size();
    for (std::size_t before = 0; before < index; ++before)
      if (job_.recordings[before].name == r.name) {
        add(Rule::name,
            fmt::format("two recordings are called '{}': give them different names", r.name));
        break;
      }
    check_samples(r);
    for (std::size_t m = 0; m < r.measurements.size(); ++m) {
      subject_.measurement = m;
      check_measurement(r, m);
    }
    subject_.measurement.reset();
    check_set_quantities(r);
    sound_.push_back(found_.size() == faults_before);
    if (!sound_.back()) return;
    check_length(r);
    check_same_samples(r, index);
    check_signals(r);
    check_criterion(r);
  }

  void check_samples(const Recording& r) {
    const std::size_t n = r.times.size();
    if (n < kLeastSamples)
      add(Rule::times,
          fmt::format("there are only {} samples: at least {} are needed", n, kLeastSamples));
    else if (!increase(r.times))
      add(Rule::times,
          fmt::format("the times must be finite and increase by {:g} s or more from sample "
                      "to sample",
                      kShortestStep));
    const Schedule& c = r.command;
    if (c.times.empty() || c.times.size() != c.values.size() || !finite(c.values) ||
        !increase(c.times))
      add(Rule::command,
          "the command must have values, each finite and with a time of its own, which "
          "increase");
    if (!(std::isfinite(r.command_sigma) && r.command_sigma >= 0.0))
      add(Rule::command,
          fmt::format("the sigma of the command must be at least 0, not {:g}", r.command_sigma));
    if (c.meaning == Meaning::reference && !job_.model.structure.closed_loop)
      add(Rule::reference,
          "the controller that follows the reference is not part of the model: set closed_loop in "
          "its structure, or give the command");
    const std::size_t expected =
        job_.model.structure.channels == nullptr ? 0 : job_.model.structure.channels->size();
    const auto is_complete = [&](const Samples& values) {
      return values.size() == n && finite(values);
    };
    if (!r.channels.empty() &&
        (r.channels.size() != expected || !std::ranges::all_of(r.channels, is_complete)))
      add(Rule::channels,
          fmt::format("channels must be none, or the {} of the model with a finite value "
                      "for each of the {} samples",
                      expected, n));
    check_flags(Rule::held_out, r.held_out, "held out", n);
  }

  static bool increase(const std::vector<double>& times) {
    constexpr double kRounding = 0.5;  // as of times from which that of the first was taken
    for (std::size_t i = 1; i < times.size(); ++i)
      if (!(times[i] - times[i - 1] >= kRounding * kShortestStep)) return false;
    return finite(times);
  }

  void check_flags(Rule rule, const std::vector<bool>& flags, const char* what,
                   std::size_t samples) {
    if (!flags.empty() && flags.size() != samples)
      add(rule, fmt::format("of {} samples it is said whether they are {}, but there are {}",
                            flags.size(), what, samples));
  }

  void check_measurement(const Recording& r, std::size_t index) {
    const Measurement& m = r.measurements[index];
    const std::size_t n = r.times.size();
    const std::string_view called = info(m.signal, job_.vocabulary()).name;
    if (!has_signal(m.signal, job_.model.structure))
      add(Rule::signal, fmt::format("the drive of this axis has no {}: remove it", called));
    if (r.find(m.signal) != &m)
      add(Rule::second_signal, fmt::format("a recording has one {}: remove the other", called));
    if (m.values.size() != n)
      add(Rule::values, fmt::format("there are {} values for {} samples", m.values.size(), n));
    else if (!finite(m.values))
      add(Rule::values, "the values must be finite: mark those that are missing as uninformative");
    check_flags(Rule::flags, m.excluded, "excluded", n);
    check_flags(Rule::flags, m.uninformative, "uninformative", n);
    const Filter& f = m.filter;
    const bool has_middle =
        f.kind != Filter::Kind::moving_average || !f.zero_phase || f.length % 2 == 1;
    if (m.hold < 1 || f.length < 1 || f.order < 1 || f.order > kHighestFilterOrder ||
        !(f.cutoff > 0.0 && f.cutoff < 0.5) || !has_middle)
      add(Rule::filter,
          fmt::format("hold and length of the filter must be at least 1, an average with "
                      "zero phase of odd length, the order between 1 and {}, and the "
                      "cutoff between 0 and 0.5 cycles per sample",
                      kHighestFilterOrder));
    check_sigma(m.sigma);
  }

  void check_sigma(double value) {
    if (!(std::isfinite(value) && value >= kMinSigma))
      add(Rule::sigma, "sigma must be above zero: residuals are divided by it");
  }

  void check_set_quantities(const Recording& r) {
    Structure structure = job_.model.structure;
    structure.closed_loop = true;  // gains may be set where this recording has no reference
    Model<double> model = job_.model;
    for (const auto& [index, value] : r.overrides) {
      const QuantityEntry* entry = used(Rule::set_quantity, index, structure);
      if (entry == nullptr) continue;
      const Quantity& q = entry->quantity;
      if (is_state(*entry) ? !std::isfinite(value) : !within(value, q))
        add(Rule::set_quantity, fmt::format("{} is set to {}, outside its range, {} to {}",
                                            entry->name, rounded(value, q.unit),
                                            rounded(q.lower, q.unit), rounded(q.upper, q.unit)));
      *members(model)[index] = value;
    }
    if (!model_error(job_.model).empty()) return;
    if (const std::string reason = model_error(model); !reason.empty()) add(Rule::model, reason);
  }

  /// The quantity of this index; null, with a fault, where an axis of this structure has none.
  const QuantityEntry* used(Rule rule, std::size_t index, const Structure& structure) {
    if (index >= quantities_.size()) {
      add(rule, fmt::format("there is no quantity {}: a model has {}", index, quantities_.size()));
      return nullptr;
    }
    const QuantityEntry& entry = quantities_[index];
    if (is_used(entry, structure)) return &entry;
    add(rule, fmt::format("{} is not used by this axis: it lacks the drive, transmission, effect "
                          "or controller for it",
                          entry.name));
    return nullptr;
  }

  /// So many steps come from a mistake in the times, or would take days to fit.
  void check_length(const Recording& r) {
    constexpr double kStepsBetweenSamples = 1e6, kSteps = 1e8;
    const double step = job_.options.step;
    std::size_t longest = 1;
    for (std::size_t i = 2; i < r.times.size(); ++i)
      if (r.times[i] - r.times[i - 1] > r.times[longest] - r.times[longest - 1]) longest = i;
    const double interval = r.times[longest] - r.times[longest - 1],
                 all = r.times.back() - r.times.front();
    if (interval > kStepsBetweenSamples * step)
      add(Rule::gap,
          fmt::format("'{}' has a gap of {:.6g} s at {:.9g} s: trim the recording before or after "
                      "it, or check the unit of time",
                      r.name, interval, r.times[longest - 1]));
    else if (all > kSteps * step)
      add(Rule::duration,
          fmt::format("'{}' lasts {:.6g} s: too long to simulate in steps of {:g} s; trim it, set "
                      "a longer step under fit, or check the unit of time",
                      r.name, all, step));
  }

  void check_same_samples(const Recording& r, std::size_t index) {
    for (std::size_t before = 0; before < index; ++before)
      if (sound_[before] && share_samples(job_.recordings[before], r))
        return add(Rule::same_samples,
                   fmt::format("'{}' has the same samples as '{}', and a recording counts once: "
                               "remove one of them, or trim them to different parts",
                               r.name, job_.recordings[before].name));
  }

  static bool can_track(const Recording& r) {
    return r.find(Signal::position) != nullptr || r.find(Signal::velocity) != nullptr;
  }

  void check_signals(const Recording& r) {
    if (r.measurements.empty()) {
      std::vector<std::string_view> names;
      for (const SignalInfo& entry : kSignalTable)
        names.push_back(info(entry.signal, job_.vocabulary()).name);
      add(Rule::measured,
          fmt::format("no measured signal: name at least one of {}", fmt::join(names, ", ")));
    } else if (r.role == Role::fit && std::ranges::none_of(r.measurements, &Measurement::fitted)) {
      add(Rule::fitted_signal,
          "nothing to fit: every signal has fit: false; remove it from one, or give the recording "
          "the role validate");
    }
    if (!r.score_initial_samples && r.initial_samples >= r.times.size())
      add(Rule::unscored,
          fmt::format(
              "with {} unscored initial samples, nothing of the {} samples is left to score",
              r.initial_samples, r.times.size()));
    if (r.initial_state == InitialState::data && !can_track(r))
      add(Rule::initial_state, "initial_state: data needs a recorded position or velocity");
  }

  /// Whether a recording suits the criterion of the fit.
  void check_criterion(const Recording& r) {
    const Criterion& criterion = job_.options.criterion;
    if (tracks(criterion)) check_tracked(r);
    const bool has_windows = job_.choose_criterion || std::holds_alternative<Windows>(criterion);
    if (r.role != Role::fit || !has_windows) return;
    if (r.command.meaning == Meaning::reference)
      add(Rule::horizon,
          fmt::format("the axis is under its controller in '{}', which brings it back by itself: "
                      "remove 'horizon', or give the recorded command as input",
                      r.name));
    else if (!can_track(r))
      add(Rule::horizon,
          fmt::format("'{}' has neither position nor velocity, from which a window could "
                      "begin: remove 'horizon'",
                      r.name));
  }

  /// The signal that an observer tracks to the end must not be late.
  void check_tracked(const Recording& r) {
    if (!can_track(r))
      add(Rule::tracked_signal, "a fixed observer gain needs a recorded position or velocity");
    Model<double> model = job_.model;
    const auto member = members(model);
    for (const auto& [index, value] : r.overrides) *member[index] = value;
    for (const QuantityEntry& entry : quantities_)
      if (is_late(entry, r) && *member[entry.index] != 0.0) add_late_instrument(entry);
    for (const Signal target : {Signal::position, Signal::velocity})
      if (const Measurement* m = r.find(target);
          m != nullptr && m->filter != Filter() && !m->filter.zero_phase)
        add(Rule::late_filter,
            fmt::format(
                "a fixed observer gain assumes that the recorded {} is not delayed, as this "
                "filter does without zero_phase: record it unfiltered or use observer: "
                "continuation",
                info(target).name));
  }

  bool is_late(const QuantityEntry& entry, const Recording& r) const {
    return is_ignored(entry, job_.options.criterion) && r.find(*entry.signal) != nullptr;
  }

  void add_late_instrument(const QuantityEntry& entry) {
    add(Rule::late_instrument,
        fmt::format(
            "a fixed observer gain assumes that the recorded {} has no {}: remove {} and "
            "{}use observer: continuation",
            entry.group, entry.quantity.symbol, entry.name,
            entry.quantity.symbol == "delay" ? "fit T_d, which delays the whole motion, or " : ""));
  }

  // ---- A free parameter ----

  void check_parameter(const FreeParameter& p, std::size_t index) {
    const QuantityEntry* entry = used(Rule::quantity, p.quantity, job_.model.structure);
    if (entry == nullptr) return;
    if (p.recording && *p.recording >= job_.recordings.size())
      return add(Rule::recording, fmt::format("there is no recording {}: the job has {}",
                                              *p.recording, job_.recordings.size()));
    for (std::size_t before = 0; before < index; ++before)
      if (const FreeParameter& other = job_.free[before];
          other.quantity == p.quantity &&
          (!other.recording || !p.recording || other.recording == p.recording))
        return add(Rule::second_free, fmt::format("{} is free twice: remove one", entry->name));
    check_bounds(p, *entry);
    if (p.prior) {
      if (!std::isfinite(p.prior->mean))
        add(Rule::prior_mean, fmt::format("the prior mean of {} must be finite", entry->name));
      check_sigma(p.prior->sigma);
    }
    if (std::ranges::any_of(job_.recordings,
                            [&](const Recording& r) { return is_late(*entry, r); }))
      add_late_instrument(*entry);
    if (p.recording || is_state(*entry)) return;
    for (const Recording& r : job_.recordings) {
      if (std::ranges::none_of(r.overrides, [&](const auto& o) { return o.first == p.quantity; }))
        continue;
      add(Rule::free_and_set,
          entry->name == "K_f"
              ? fmt::format(
                    "K_f cannot be fitted to '{}', which has no command: its {} acts as it is",
                    r.name, words_on(job_.vocabulary(), "drive_force"))
              : fmt::format("{} is fitted for all recordings but set for '{}': remove one, or use "
                            "per_recording: true",
                            entry->name, r.name));
    }
  }

  void check_bounds(const FreeParameter& p, const QuantityEntry& entry) {
    const Quantity& q = entry.quantity;
    const std::string lower = rounded(p.lower, q.unit), upper = rounded(p.upper, q.unit);
    if (p.scale == Scale::logarithmic && !(p.lower > 0.0 && p.initial > 0.0))
      add(Rule::scale,
          fmt::format("{} on a logarithmic scale needs an initial value and a lower bound "
                      "above zero",
                      entry.name));
    else if (p.scale == Scale::from_zero && !(p.lower >= 0.0 && p.initial > 0.0))
      add(Rule::scale,
          fmt::format("{} on a scale from zero needs an initial value above zero and a "
                      "lower bound of zero or above",
                      entry.name));
    else if (!(p.lower <= p.initial && p.initial <= p.upper))
      add(Rule::initial, fmt::format("the initial value {} of {} lies outside its bounds, {} to {}",
                                     rounded(p.initial, q.unit), entry.name, lower, upper));
    else if (!(p.lower < p.upper && within(p.lower, q) && within(p.upper, q)))
      add(Rule::bounds,
          fmt::format("the bounds of {}, {} to {}, must be apart and within its range, {} "
                      "to {}",
                      entry.name, lower, upper, rounded(q.lower, q.unit),
                      rounded(q.upper, q.unit)));
  }

  // ---- The job ----

  void check_options() {
    const FitOptions& o = job_.options;
    for (const auto& [what, value, least] :
         std::initializer_list<std::tuple<const char*, double, double>>{
             {"observer_gain", given_gain(o.criterion), 0.0},
             {"initial_observer_gain", o.continuation ? o.continuation->start_gain : 0.0, 0.0},
             {"horizon", window_length(o.criterion), 0.0},
             {"huber_width", o.huber_width, 0.1},
             {"max_iterations", o.max_iterations, 1.0},
             {"tolerance", o.tolerance, 0.0},
             {"attempts", o.attempts, 1.0},
             {"starts", o.starts, 1.0},
             {"spread", o.spread, 1.0},
             {"threads", o.threads, 0.0},
             {"step", o.step, 1e-7},
             {"input_noise_draws", o.input_noise_draws, 2.0}})
      if (!(std::isfinite(value) && value >= least))
        add(Rule::options, fmt::format("{} must be at least {:g}, not {:g}", what, least, value));
    const MachineLimits& l = job_.limits;
    const auto positive = [](std::optional<double> x) { return !x || *x > 0.0; };
    if ((l.lowest && l.highest && !(*l.lowest < *l.highest)) || !positive(l.speed) ||
        !positive(l.command))
      add(Rule::limits,
          "the limits must have the lowest position below the highest, and a speed and "
          "command above zero");
  }

  void check_model() {
    for (const std::size_t index : job_.guessed) used(Rule::guessed, index, job_.model.structure);
    const Structure& structure = job_.model.structure;
    if (structure.channels != nullptr && structure.channels->size() > kChannels)
      add(Rule::channels,
          fmt::format("an axis has at most {} channels: leave out those that cannot act "
                      "on it",
                      kChannels));
    if (const std::string reason = model_error(job_.model); !reason.empty())
      add(Rule::model, reason);
    Model<double> model = job_.model;
    const auto member = members(model);
    for (const QuantityEntry& entry : quantities_) {
      const Quantity& q = entry.quantity;
      const double x = *member[entry.index];
      const bool is_required = std::isnan(q.default_value);
      if (is_used(entry, structure) && !(is_required ? within(x, q) : std::isfinite(x)) &&
          !is_replaced(entry.index))
        add(Rule::value,
            fmt::format("{} is {}, outside its range, {} to {}", entry.name, rounded(x, q.unit),
                        rounded(q.lower, q.unit), rounded(q.upper, q.unit)));
    }
  }

  /// Whether every recording has a value of its own of the quantity, or a free one.
  bool is_replaced(std::size_t quantity) const {
    for (std::size_t r = 0; r < job_.recordings.size(); ++r) {
      const bool is_set = std::ranges::any_of(job_.recordings[r].overrides,
                                              [&](const auto& o) { return o.first == quantity; });
      const bool is_free = std::ranges::any_of(job_.free, [&](const FreeParameter& p) {
        return p.quantity == quantity && (!p.recording || *p.recording == r);
      });
      if (!is_set && !is_free) return false;
    }
    return true;
  }

  /// Whether there is something to fit, and more to fit it to.
  void check_extent() {
    if (job_.free.empty()) add(Rule::free_quantity, "no free quantity: name at least one to fit");
    if (std::ranges::count(job_.recordings, Role::fit, &Recording::role) == 0)
      add(Rule::fitted_recording, "no recording has the role fit: at least one must");
    if (!found_.empty()) return;
    std::size_t fitted = 0;
    for (const Recording& r : job_.recordings)
      for (const Measurement& m : r.measurements)
        for (std::size_t i = 0; i < m.values.size(); ++i) fitted += r.fits(m, i);
    for (const FreeParameter& p : job_.free) fitted += p.prior.has_value();
    if (fitted <= job_.free.size())
      add(Rule::degrees_of_freedom,
          fmt::format("{} values, priors included, cannot determine {} parameters: free fewer "
                      "parameters or fit more samples",
                      fitted, job_.free.size()));
  }

  const Job& job_;
  const std::vector<QuantityEntry>& quantities_;
  Subject subject_;
  std::vector<bool> sound_;  ///< of the recordings so far: their samples can be looked at
  std::vector<JobFault> found_;
};

/// "recording 'fit', velocity: " or "free M: "; empty for the job itself.
std::string place_of(const JobFault& fault, const Job& job) {
  if (fault.parameter) {
    const std::size_t quantity = job.free[*fault.parameter].quantity;
    return fault.rule == Rule::quantity ? "free: "
                                        : fmt::format("free {}: ", job.entry(quantity).name);
  }
  if (!fault.recording) return "";
  const Recording& r = job.recordings[*fault.recording];
  return fault.measurement
             ? fmt::format("recording '{}', {}: ", r.name,
                           info(r.measurements[*fault.measurement].signal, job.vocabulary()).name)
             : fmt::format("recording '{}': ", r.name);
}

}  // namespace

std::vector<JobFault> faults(const Job& job) { return JobCheck(job).run(); }

void validate(const Job& job) {
  std::string message;
  for (const JobFault& fault : faults(job))
    message += (message.empty() ? "" : "\n") + place_of(fault, job) + fault.message;
  if (!message.empty()) throw std::invalid_argument(message);
}

}  // namespace axisfit
