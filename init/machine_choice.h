// Which kind of axis recordings are of, where nobody says it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/solve/run_context.h"
#include "init/init_job.h"

namespace axisfit {

/// A kind of axis that was fitted to recordings.
struct TriedAxis {
  std::string name;  ///< of a machine; "mass": one mass and what drives it
  /// Root mean square of the error over the noise, of what was not fitted or else of what was. None
  /// where the fit did not converge.
  std::optional<double> error;
  std::size_t parameters = 0;  ///< that are free
};

struct MachineChoice {
  InitialJob job;
  std::vector<TriedAxis> tried;  ///< those that the columns suit, the chosen one first
  bool is_explained = true;      ///< the chosen one leaves less than ten times the noise
  bool is_validated = false;     ///< the errors are of a recording that was not fitted
};

/// As initial_job() without an axis. Where the first look leaves more of the force than one mass
/// with friction may, and tells the sign of the input, it also fits every machine which the columns
/// suit, and takes the one with the smallest error: of those within a twentieth of it that with the
/// fewest parameters. One that leaves more than ten times the noise is no better than one mass.
/// Recordings of more than 20000 samples and those of a velocity loop are not tried: tried is then
/// empty.
///
/// When the stop flag is set, it is one of those that were tried, or one mass. Throws
/// std::runtime_error where the recordings make no job.
MachineChoice choose_machine(const InitRequest& request, const RunContext& context = {},
                             int threads = 0);

}  // namespace axisfit
