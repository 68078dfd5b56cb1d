// An axis that is moved step by step from outside: what an FMU does, whatever the standard's
// version.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sim/integrator.h"

namespace axisfit {

/// Variables go by numbers, the standard's value references: from each of these on, all of a kind.
enum VariableReference : std::uint32_t {
  kTimeVariable = 0,
  kCommandVariable = 1,      ///< the command, in the unit of the drive
  kChannelVariables = 2,     ///< by their place
  kSignalVariables = 100,    ///< what the instruments read, without lag and delay; by their place
  kStateVariables = 200,     ///< y0 to y9
  kQuantityVariables = 1000  ///< in the list of quantities; SI units
};

/// All errors are std::runtime_error.
class AxisUnit {
 public:
  explicit AxisUnit(Model<double> model);

  /// At the present time. Inputs and quantities are as they were set last.
  double value(std::uint32_t reference);
  /// Inputs act from the present time on, the command later by the dead time; they hold until they
  /// are set again. Quantities can change in motion, but those of the start.
  void set(std::uint32_t reference, double value);

  /// s. To be set before anything moves.
  void set_start(double time);
  /// Back to the model that it was made of, before the start.
  void reset();
  /// Moves on by so many seconds, from the present time, which is given within rounding.
  void step(double from, double length);
  double time() const { return time_; }

  /// All that its future depends on.
  std::vector<char> snapshot();
  /// Goes on from there, within rounding. Throws for one that is not of an axis like this.
  void restore(std::span<const char> snapshot);

 private:
  using Axis = Integrator<double>;
  struct Fixed;

  Axis& axis();
  void renew_axis();
  void take_inputs();

  Model<double> initial_, model_;
  std::vector<double*> quantities_;  // of model_
  double time_ = 0.0;                // s
  bool has_moved_ = false;
  bool has_new_quantities_ = false;  // since the integrator was made
  std::unique_ptr<Axis> axis_;
  double command_ = 0.0;
  std::array<double, kChannels> channels_{};  // beyond their zeros
  /// Commands that the dead time holds back: s, value.
  std::vector<std::pair<double, double>> pending_;
};

}  // namespace axisfit
