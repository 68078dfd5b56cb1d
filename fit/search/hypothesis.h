// What a model may lack, as something that can be added to it and put to the test.
//
// The life of a hypothesis: the catalogue lists it (Hypothesis), the score test says what it would
// gain (Scored), a refit with it is put to the acceptance test (Tried), and what passes becomes
// part of the model (Accepted). An Outcome says what became of each that was refitted.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fit/estimate/estimate.h"

namespace axisfit {

enum class HypothesisKind {
  effect,        ///< physics of the machine that has a name
  curve,         ///< a force curve: it fits whatever no named effect explains
  instrument,    ///< the gain, bias or lag of what reads the machine
  clock,         ///< the input or an instrument is late, or ever later: no part of the machine
  constant,      ///< a value of the axis file that is not free is another
  transmission,  ///< another variant of the transmission, see transmission.h
};

struct Hypothesis {
  std::string name;     ///< "coulomb_friction", "acceleration.bias"
  std::string acts_on;  ///< "arm force", "friction", "inertia", "drive", "sensor" ...
  std::string meaning;  ///< a few words
  HypothesisKind kind = HypothesisKind::effect;
  /// Quantities (indices in quantity_list()) that are estimated, and what they are while it is
  /// absent: zero, one for a gain, infinite for a stiffness, and what the axis file declares for a
  /// constant.
  std::vector<std::size_t> strengths;
  std::vector<double> neutral;
  /// Quantities that give it its shape, and the settings of them to be tried, one value for each.
  /// Without shapes there is one empty setting. The shapes are estimated too, but for the last
  /// `held`, which stay at a setting: the ends of a curve, and exponents that make another law.
  /// That the recordings leave a shape of a transmission open is no ground to doubt it.
  std::vector<std::size_t> shapes;
  std::size_t held = 0;
  std::vector<std::vector<double>> settings;
  std::vector<double> largest;  ///< of each shape; empty: what the quantity may be
  bool has_phase = false;       ///< the strengths are sine and cosine of a phase
  /// Strengths at which the score test looks instead of at zero, where the derivative there says
  /// little: that of a lag or delay holds while it is shorter than anything else. Empty: none.
  std::vector<double> probes = {};
  std::string extends = {};  ///< the effect beside which alone it is offered; empty: any model
  /// The only recording that differs by it, such as by a payload; none: it is the same in all.
  std::optional<std::size_t> recording = {};

  /// The least and the most that is tried of one of its shapes.
  std::pair<double, double> range_tried(std::size_t shape) const;
  std::span<const std::size_t> estimated_shapes() const {
    return std::span(shapes).first(shapes.size() - held);
  }
  /// As which parameters one of its strengths and one of its shapes are estimated.
  ParameterId strength(std::size_t i) const { return {strengths[i], recording}; }
  ParameterId shape(std::size_t i) const { return {shapes[i], recording}; }
  /// Whether it is in what is read of the machine, not in the machine.
  bool is_of_instrument() const;
  std::size_t parameters() const { return strengths.size() + estimated_shapes().size(); }
};

/// What the quantities of a hypothesis are, in its order.
struct HypothesisValues {
  std::vector<double> strengths, shapes;
};

/// Whether they are the same hypothesis, whatever the shape.
inline bool is_same(const Hypothesis& a, const Hypothesis& b) {
  return a.strengths == b.strengths && a.recording == b.recording;
}

/// Whether they have the same shapes, too: an effect may be offered with a shape, and without it as
/// the simpler law that it then is.
inline bool is_same_form(const Hypothesis& a, const Hypothesis& b) {
  return is_same(a, b) && a.shapes == b.shapes;
}

/// Whether it is a law of one number, and the other a richer one that acts on the same. What is
/// large is told wrongly to first order: there a bump as wide as the stroke gains more than the
/// plain friction that it stands for.
bool is_plain_beside(const Hypothesis& hypothesis, const Hypothesis& other);

/// Whether one is a part of another's effect that does nothing without it.
bool is_part_of(const Hypothesis& part, const Hypothesis& whole);

/// How far a strength is from what it is while the effect is absent; of a stiffness, which is
/// infinite then, the compliance.
double distance_from_neutral(double value, double neutral);

/// What a quantity is where nobody says otherwise: its default, or else zero.
double neutral_value(const Quantity& quantity);

/// The structure with the effect of a quantity, if it belongs to one.
Structure with_effect_of(Structure structure, std::size_t quantity);

/// The job with the hypothesis added: its parameters become the last free ones and start from
/// `own`, the other free parameters from `others` (the first so many). With `fixed_shapes` the
/// shapes stay as they are given.
Job with_hypothesis(const Job& job, const Hypothesis& hypothesis, std::span<const double> others,
                    const HypothesisValues& own, bool fixed_shapes = false);

/// What the quantities of a hypothesis are in a fit with it.
HypothesisValues values_in(const Job& job, const FitResult& fit, const Hypothesis& hypothesis);

/// The same where nothing else estimates its held shapes: each is that of the nearest setting.
HypothesisValues held_at_settings(const Hypothesis& hypothesis, HypothesisValues own);

}  // namespace axisfit
