// How the parameters of a machine differ from recording to recording.
//
// A standard error says how well one recording, or all of them together, determine a parameter, as
// if it were the same in all of them. Friction, offsets and gains do not: they change with
// temperature, grease and load. So every recording gets parameters of its own about those of the
// machine, b_i = b + N(0, T) with T diagonal, and the standard deviations in T are estimated, too.
//
// Near the solution the problem is linear: with J_i and r_i the rows of a recording, it would move
// the estimates by d_i = -(J_i'J_i)^-1 J_i'r_i alone, with the covariance C_i of its own coloured
// residual (uncertainty.h). d_i is normal about the machine's with C_i + T, and T maximises the
// restricted likelihood. A standard deviation counts where its likelihood ratio is significant at
// 20 %. The estimate of all recordings together is the mean of d_i with the weights P_i = (J'J)^-1
// J_i'J_i. Its variance grows by the sum of P_i T P_i', which is known the better, the more groups
// there are.
//
// Literature: D. A. Harville, Journal of the American Statistical Association 72 (1977).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "fit/data/job.h"
#include "fit/errors/parameter_result.h"

namespace axisfit {

/// The estimate of a parameter by one recording, or a stretch of one, alone.
struct EstimateOfGroup {
  double value = 0.0, standard_error = 0.0;  ///< in the quantity's unit
  bool determined = false;
};

/// The scatter of one free parameter.
struct ParameterScatter {
  std::size_t parameter = 0;  ///< its place in Job::free
  /// Standard deviation between groups, in the quantity's unit; zero where they show none.
  double deviation = 0.0;
  double lower = 0.0, upper = 0.0;      ///< its 95 % interval, by the profile of the likelihood
  double within = 0.0;                  ///< standard error of the estimate without it
  std::optional<ScatterError> error{};  ///< what it adds to that; none where groups show none
  std::vector<EstimateOfGroup> groups{};
};

/// What is compared: recordings, or stretches of the only one that was fitted.
struct Scatter {
  struct Group {
    std::size_t recording = 0;
    bool fitted = true;           ///< others are only shown
    double from = 0.0, to = 0.0;  ///< s
  };
  std::vector<Group> groups;
  bool of_stretches = false;
  std::vector<ParameterScatter> parameters;  ///< those of the machine that are determined

  std::size_t fitted_groups() const;
};

/// Whether a free parameter is one of the machine, and not of one recording or of how a motion
/// begins.
bool is_of_machine(const Job& job, std::size_t parameter);

/// The scatter behind the estimates of a usable fit at this observer gain, whose budgets have none
/// yet. Groups are two or more fitted recordings, or stretches of one that the fit tracks with a
/// fixed observer or simulates in short windows (otherwise a stretch depends on those before it).
/// Recordings to validate are shown, too, and have no share. None where there is nothing to
/// compare. Parameters at a bound, of one recording alone and of the initial state have no scatter.
/// Costs one residual with its Jacobian.
std::optional<Scatter> scatter_of(const Job& job, std::span<const ParameterResult> parameters,
                                  double observer_gain, const ErrorOptions& options = {});

/// The same, entered in their budgets.
std::optional<Scatter> add_scatter(const Job& job, std::span<ParameterResult> parameters,
                                   double observer_gain, const ErrorOptions& options = {});

}  // namespace axisfit
