// Solutions that a long run stores, so that it can be resumed.
//
// A fit, a multistart, a profile and the search for effects are long because they solve many
// least-squares problems, one after another and in parallel. Each solution depends on its problem
// alone, and everything else on the solutions. A run that finds the solutions of an earlier one
// therefore ends with the same digits, whatever the number of threads. A solution is looked up by
// a hash of its complete problem, so that a stale one is never used.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "fit/solve/least_squares.h"

namespace axisfit {

/// Tells problems apart: a hash of all that their solution follows from, bit by bit.
using ProblemKey = std::array<std::uint64_t, 2>;

/// The key of the problem that solve() is given.
ProblemKey problem_key(const Job& job, const Eigen::VectorXd& u, double observer_gain,
                       const SolveOptions& options);

/// Solutions of problems. Called from several threads at once.
class Journal {
 public:
  virtual ~Journal() = default;
  virtual std::optional<SolveResult> find(const ProblemKey& key) = 0;
  virtual void store(const ProblemKey& key, const SolveResult& solution) = 0;
};

}  // namespace axisfit
