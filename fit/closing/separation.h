// What would tell two models apart that explain the same recordings.
#pragma once

#include <string>

#include "fit/job.h"

namespace axisfit {

/// Which signal in which motion differs most between two models, in a sentence. Tried are the
/// motions of the job's recordings with the signals that they lack, and others that stay within
/// their voltages: a step, levels, a slow sine, a chirp and a pseudo-random sequence. Differences
/// are counted in the job's noise of a signal, or, where it has none, in thousandths of its range.
std::string what_separates(const Job& job, const Model<double>& a, const Model<double>& b);

}  // namespace axisfit
