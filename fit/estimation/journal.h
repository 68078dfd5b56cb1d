// What long work keeps of itself, so that it can go on after it was ended.
//
// A fit, a multistart, a profile and the search for effects are long because they solve many
// least-squares problems, one after another and side by side. Each solution follows from its
// problem alone, and everything else from the solutions. A run that finds the solutions of an
// earlier one therefore ends where that one would have ended, digit for digit, whatever the number
// of threads; and what the problem was is told by the problem itself, so that nothing stale is
// ever taken for its solution.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "fit/estimation/least_squares.h"

namespace axisfit {

/// Tells problems apart: a hash of all that their solution follows from, bit by bit.
using ProblemKey = std::array<std::uint64_t, 2>;

/// Of what solve() is given.
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
