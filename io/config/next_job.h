// The job that goes on from a result.
#pragma once

#include <string>

#include "fit/data/job.h"
#include "io/config/job_file.h"

namespace axisfit {

/// The job file `declared` as it would be after `reached`, whose axis, with the effects that were
/// accepted, stands in `axis_name` beside it: initial values are those, what the effects
/// brought is free, and the simulation tracks if that was found to be necessary. Comments are lost.
/// Paths start at `folder`, where it is meant to go, instead of at that of `path`, the declared
/// job, or of `data_directory`, unless that is empty. `comment` becomes its first lines.
std::string next_job_text(const JobFile& declared, const Job& reached, const std::string& path,
                          const std::string& data_directory, const std::string& folder,
                          const std::string& axis_name, const std::string& comment);

}  // namespace axisfit
