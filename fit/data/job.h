// A fit as data: the model, the recordings, what is free, and how to go about it.
// Nothing here knows where it was read from.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fit/data/criterion.h"
#include "fit/data/filter.h"
#include "sim/command.h"
#include "sim/model.h"

namespace axisfit {

enum class Role {
  fit,       ///< its residuals are minimised
  validate,  ///< only judged
};

/// How the initial state of a recording is found.
enum class InitialState {
  given,  ///< the model's, or the recording's overrides
  data,   ///< position and velocity from the first samples; the rest as given
};

/// Where the size of a measurement's noise comes from.
enum class NoiseSource {
  given,
  differences,  ///< of the samples, see noise.h
  standstill,   ///< what the instrument shows at rest, see standstill.h
  fit,          ///< estimated together with the parameters, see estimate_with_noise
};

/// One measured signal of a recording, in SI units.
struct Measurement {
  Signal signal = Signal::velocity;
  Samples values;      ///< one per sample
  double sigma = 0.0;  ///< standard deviation of its noise, > 0
  NoiseSource noise = NoiseSource::differences;
  bool fitted = true;  ///< false: compared and reported, not part of the fit
  /// Samples that are neither fitted nor judged, see standstill.h; empty: none.
  std::vector<bool> excluded;
  Filter filter;         ///< that the samples went through before they were recorded
  std::size_t hold = 1;  ///< how often each of them was then recorded
  /// Samples that are neither fitted nor judged because of the two, see exclude_uninformative(), or
  /// because there is no value; empty: none.
  std::vector<bool> uninformative;
  std::size_t missing = 0;  ///< values that the recording lacks at times of its own

  bool counts(std::size_t sample) const {
    return (excluded.empty() || !excluded[sample]) &&
           (uninformative.empty() || !uninformative[sample]);
  }
};

/// For a measurement that is filtered or held: sets `uninformative` to the samples that only
/// repeat, and to those closer to an end than the filter reaches (with a causal one, to the first),
/// since their values depend on what was not recorded. Samples that only repeat are replaced by a
/// curve between the fresh ones, so that everything computed from the values sees the signal and
/// not its stairs.
void exclude_uninformative(Measurement& measurement);

/// How many samples of the measurement's noise carry as much information as one independent one;
/// above one where its filter correlates them. Those that only repeat do not count.
double noise_correlation_time(const Measurement& measurement);

/// One recording. Samples run over `times`.
struct Recording {
  std::string name;  ///< short, unique within the job
  std::string file;  ///< as the user wrote it
  Role role = Role::fit;
  Samples times;     ///< s, increasing, at least two
  Schedule command;  ///< in the unit of the drive, or the reference of its controller, m
  /// Standard deviation of the noise with which the command was recorded, V: white, of each value
  /// of the schedule. Zero: the axis received exactly this command.
  double command_sigma = 0.0;
  NoiseSource command_noise = NoiseSource::given;  ///< or differences
  std::vector<Measurement> measurements;
  /// The model's channels beyond their zero, one value per sample; none: all at their zero.
  std::vector<Samples> channels{};
  InitialState initial_state = InitialState::given;
  /// Whether the arm's initial position and velocity are known although the others are from data.
  bool knows_position = false, knows_velocity = false;
  /// Samples at the start from which an initial state is taken.
  std::size_t initial_samples = 20;
  bool score_initial_samples = true;        ///< false: errors are reported without them
  bool acceleration_at_standstill = false;  ///< see standstill.h
  /// Samples of a recording to be fitted that are only judged, as if they were another recording;
  /// empty: none.
  std::vector<bool> held_out;
  /// Quantities that differ from the model's in this recording: index in quantity_list(), value.
  std::vector<std::pair<std::size_t, double>> overrides;

  bool fits(const Measurement& measurement, std::size_t sample) const {
    return role == Role::fit && measurement.fitted && measurement.counts(sample) &&
           (held_out.empty() || !held_out[sample]);
  }

  /// How the channels run from this instant (s) on, until the next sample.
  ChannelCourse course_at(double time) const;

  const Measurement* find(Signal signal) const {
    for (const Measurement& m : measurements)
      if (m.signal == signal) return &m;
    return nullptr;
  }
};

/// Whether two recordings are the same one, wholly or in part, whatever their names: at the times
/// that they share they have the same values of every signal that both have. Fitted twice, a
/// recording would make standard errors too small; once fitted, it cannot validate.
bool share_samples(const Recording& a, const Recording& b);

/// Gaussian knowledge from elsewhere: value = mean +- sigma.
struct Prior {
  double mean = 0.0;
  double sigma = 0.0;
};

/// The free parameter of a job that a result is about. Where several axes are fitted at once, the
/// axis will belong here.
struct ParameterId {
  std::size_t quantity = 0;                ///< index in quantity_list()
  std::optional<std::size_t> recording{};  ///< the only one it applies to; none: all of them

  bool operator==(const ParameterId&) const = default;
};

/// The scale on which a quantity is estimated: a step of the fit is a part of the value on a
/// logarithmic one, and an amount on a linear one.
enum class Scale {
  linear,
  logarithmic,
  /// Of what is no less than zero, and may be none: logarithmic far above a hundredth of the
  /// initial value, linear below it, so that the fit reaches zero.
  from_zero,
};

/// A quantity that is estimated.
struct FreeParameter {
  std::size_t quantity = 0;              ///< index in quantity_list()
  std::optional<std::size_t> recording;  ///< the only recording it applies to; none: all of them
  double initial = 0.0;
  double lower = 0.0;  ///< lower <= initial <= upper
  double upper = 0.0;
  Scale scale = Scale::logarithmic;  ///< needs lower > 0, or from zero lower >= 0 and initial > 0
  std::optional<Prior> prior;

  ParameterId id() const { return {quantity, recording}; }
};

/// A free parameter shared by all recordings, within the quantity's range, on its scale of choice
/// (scale_of()) if the initial value is above zero, and otherwise on a linear one.
FreeParameter free_parameter(const QuantityEntry& entry, double initial);
/// The same by the name that the sources use. Throws std::logic_error for a name that they do not
/// know.
FreeParameter free_parameter(std::string_view name, double initial);

/// The scale on which a quantity is estimated where nobody says otherwise. What has no zero in its
/// range, or is part of every axis, is estimated by its order of magnitude; frictions beyond the
/// viscous one, biases, delays and initial states are not.
Scale scale_of(const QuantityEntry& entry, double initial);

/// Whether a fit by this criterion takes the quantity to be zero: the lag or delay of a position or
/// velocity where the fit tracks. A simulation that tracks a late signal is late itself.
bool is_ignored(const QuantityEntry& entry, const Criterion& criterion);

enum class Loss { squares, huber };

struct FitOptions {
  Criterion criterion;
  /// None: plain least squares from the start. Tracking takes none, see is_continued().
  std::optional<Continuation> continuation = Continuation{};
  Loss loss = Loss::squares;
  double huber_width = 3.0;  ///< residuals above this many sigma count linearly
  int max_iterations = 50;   ///< of each stage of the continuation
  double tolerance = 1e-10;  ///< relative change of the cost at which the last stage stops
  int attempts = 4;          ///< continuations of a start, while they end unexplained
  int starts = 1;            ///< the first from the initial values, the others drawn around them
  double spread = 5.0;       ///< starts are drawn within this factor, either way
  std::uint64_t seed = 1;
  int threads = 0;             ///< 0: as many as the machine has
  double step = 0.5e-3;        ///< s, of the integrator
  int input_noise_draws = 64;  ///< see input_noise.h; their standard deviation errs by 9 %
  /// A reduced cost (stage.h) that the fit must come below to be of use. Where at its pace it would
  /// not, the last stage ends without a minimum.
  double give_up_above = std::numeric_limits<double>::infinity();

  bool is_continued() const { return continuation && !tracks(criterion); }
};

/// Limits of the motions that the machine may be asked for. A limit that is not given is what the
/// recordings covered, since the machine withstood that; for the command of an electric drive it is
/// the limit of its controller.
struct MachineLimits {
  std::optional<double> lowest{}, highest{};  ///< m, position of the arm
  std::optional<double> speed{};              ///< m/s of the arm, either way
  std::optional<double> command{};            ///< in the unit of the drive, either way
};

struct Job {
  std::string axis;  ///< its name, for reports
  Model<double> model;
  MachineLimits limits;  ///< of experiments yet to be made
  std::vector<Recording> recordings;
  std::vector<FreeParameter> free;
  std::vector<std::size_t> guessed{};  ///< quantities whose values are guesses, in quantity_list()
  FitOptions options;
  /// run() chooses options.criterion, or has chosen it, see horizon.h; else it is given.
  bool choose_criterion = false;

  Vocabulary vocabulary() const { return vocabulary_of(model.structure); }
  /// The entry of a quantity for the job's axis.
  const QuantityEntry& entry(std::size_t quantity) const {
    return quantity_list(vocabulary())[quantity];
  }
};

/// The job with the roles of its recordings exchanged: those to validate are fitted, with all their
/// samples. None where there are none, or where a free parameter belongs to one recording or is set
/// in a recording to validate.
std::optional<Job> with_exchanged_roles(Job job);

}  // namespace axisfit
