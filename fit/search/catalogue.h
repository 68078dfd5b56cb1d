// The catalogue: all candidates that a model may lack.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fit/data/job.h"

namespace axisfit {

/// One effect that is absent from a job's model, as something that could be added to it.
struct Candidate {
  std::string name;  ///< "coulomb_friction", "acceleration.bias"
  std::string
      acts_on;  ///< where it acts: "arm force", "friction", "inertia", "drive", "sensor" ...
  std::string meaning;  ///< a few words
  /// Quantities (indices in quantity_list()) that are estimated, and what they are while it is
  /// absent: zero, one for a gain, infinite for a stiffness, and what the axis file declares for a
  /// constant.
  std::vector<std::size_t> strengths;
  std::vector<double> neutral;
  /// Quantities that give it its shape, and the settings of them to be tried, one value for each.
  /// A candidate without shapes has one empty setting.
  std::vector<std::size_t> shapes;
  std::vector<std::vector<double>> settings;
  std::vector<double> largest;  ///< of each shape; empty: what the quantity may be
  bool shapes_are_free = true;  ///< whether the shapes are estimated too; a curve's ends are not
  /// Strengths at which the score test looks instead of at zero, where the derivative there says
  /// little: that of a lag or delay holds while it is shorter than anything else. Empty: none.
  std::vector<double> probes = {};
  std::string extends = {};  ///< the effect beside which alone it is offered; empty: any model
  bool is_curve = false;     ///< a curve: it fits whatever no other effect explains
  bool has_phase = false;    ///< the strengths are sine and cosine of a phase
  bool is_timing =
      false;  ///< a clock that is off: of the input, or a delay or drift of an instrument
  /// Another variant of the transmission, see backlash.h. That the recordings leave a shape of it
  /// open is no ground to doubt it.
  bool gives_backlash = false;
  /// A value of the axis file that is not free: the hypothesis is that it is another.
  bool is_constant = false;

  /// Whether it is in what is read of the machine, not in the machine.
  bool is_instrument() const;
  std::size_t parameters() const {
    return strengths.size() + (shapes_are_free ? shapes.size() : 0);
  }
};

/// Whether they are the same effect, whatever its shape.
inline bool same_effect(const Candidate& a, const Candidate& b) {
  return a.strengths == b.strengths;
}

/// How far a strength is from what it is while the effect is absent; of a stiffness, which is
/// infinite then, the compliance.
inline double distance_from_neutral(double value, double neutral) {
  return std::isinf(neutral) ? 1.0 / value : value - neutral;
}

/// Whether a candidate is a part of another's effect that does nothing without it.
bool is_part_of(const Candidate& part, const Candidate& whole);

/// All candidates that the job's axis can have, its recordings could show, and its model lacks:
/// effects, instruments that are not as they should be, and constants that are not what the axis
/// file says. The pinion radius is the job's.
std::vector<Candidate> catalogue(const Job& job, SearchScales scales);

/// The job with the candidate added to its free parameters, started from these strengths and
/// shapes, the other free parameters from `values`.
Job with_candidate(const Job& job, const Candidate& candidate, std::span<const double> values,
                   std::span<const double> strengths, std::span<const double> shapes);

}  // namespace axisfit
