// The part of recordings that tells most of how the axis moves: enough for what is only compared.
#pragma once

#include <cstddef>

#include "init/job_draft.h"

namespace axisfit {

inline constexpr std::size_t kEnoughSamples = 2000;  ///< to tell hold from delay, or a machine

/// Of every recording the stretch in which the speed changes most, so long that all together have
/// `samples`, or of many recordings 200 each; shorter ones are kept whole.
void keep_busiest(JobDraft& draft, std::size_t samples);

}  // namespace axisfit
