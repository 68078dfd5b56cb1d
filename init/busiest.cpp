#include "init/busiest.h"

#include <algorithm>
#include <cmath>

namespace axisfit {
namespace {

/// The first of `most` samples in which the speed changes most. A part of the stretch counts as one
/// step, so that noise from sample to sample does not.
std::size_t busiest_start(const RecordingGuess& guess, std::size_t most) {
  constexpr std::size_t kParts = 32;
  const GuessedColumn* velocity = guess.find(Kind::velocity);
  const GuessedColumn* moved = velocity != nullptr ? velocity : guess.find(Kind::position);
  if (moved == nullptr) return 0;
  const std::size_t step = std::max<std::size_t>(1, most / kParts), within = most / step;
  std::vector<double> x;  // at the ends of parts, the last sample one of them
  for (std::size_t i = (moved->values.size() - 1) % step; i < moved->values.size(); i += step)
    x.push_back(moved->values[i]);
  const auto change = [&](std::size_t i) {
    return std::abs(velocity != nullptr ? x[i + 1] - x[i] : x[i + 1] - 2.0 * x[i] + x[i - 1]);
  };
  double sum = 0.0, largest = 0.0;
  std::size_t end = within;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    sum += change(i);
    if (i > within) sum -= change(i - within);
    if (sum <= largest) continue;
    largest = sum;
    end = std::max(end, i + 1);
  }
  return std::min((end - within) * step, moved->values.size() - most);
}

}  // namespace

void keep_busiest(JobDraft& draft, std::size_t samples) {
  constexpr std::size_t kFewest = 200;  // that show a motion
  const std::size_t most = std::max(kFewest, samples / draft.recordings.size());
  for (DraftRecording& recording : draft.recordings) {
    const std::vector<double>& times = recording.guess.time.values;
    if (times.size() <= most) continue;
    const std::size_t start = busiest_start(recording.guess, most);
    recording.trim_from = times[start];
    recording.trim_to = times[start + most - 1];
    recording.keep_samples(start, most);
  }
}

}  // namespace axisfit
