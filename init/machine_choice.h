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
  bool is_validated = false;     ///< the errors are of a recording that was not fitted
};

/// As initial_job() without an axis, but that it fits every machine which the columns suit, and one
/// mass, and takes the one with the smallest error: of those within a twentieth of it that with
/// the fewest parameters. Recordings of more than 50000 samples and those of a velocity loop are
/// not tried: tried is then empty.
///
/// Throws std::runtime_error where the recordings make no job, and Interrupted.
MachineChoice choose_machine(const std::vector<std::string>& recordings, const std::string& folder,
                             const std::vector<ColumnAnswer>& answers = {},
                             const RunContext& context = {});

}  // namespace axisfit
