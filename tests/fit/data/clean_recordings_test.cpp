// Recordings in which nothing is wrong cause no warning, and faults put into them are found.
#include "tests/fit/data/clean_recordings.h"

#include <gtest/gtest.h>

#include "fit/data/filter.h"
#include "fit/data/recording_warnings.h"

namespace axisfit::clean {
namespace {

constexpr std::uint64_t kRecordings = 200;

TEST(CleanRecordingsTest, CauseNoWarning) {
  Job job;
  job.model.structure.drive = Drive::force_source;
  for (std::uint64_t seed = 1; seed <= kRecordings; ++seed) {
    const Clean clean = clean_recording(seed);
    const RecordingCheck check = check_recording(clean.recording);
    for (const RecordingWarning& w : warnings_of(job, clean.recording, check))
      ADD_FAILURE() << clean.name << ": warning " << w.index();
  }
}

/// How many of the faults were found.
struct Score {
  int found = 0, of = 0;

  void add(bool is_found) {
    ++of;
    found += is_found ? 1 : 0;
  }
  double share() const { return static_cast<double>(found) / static_cast<double>(of); }
};

/// Whether the arm moves during some samples while a signal visibly changes.
bool is_busy(const Clean& clean, const std::vector<double>& values, std::size_t from,
             std::size_t length) {
  const auto begin = values.begin() + static_cast<std::ptrdiff_t>(from);
  const std::vector<double> part(begin, begin + static_cast<std::ptrdiff_t>(length));
  std::size_t changes = 0;
  for (std::size_t i = 1; i < length; ++i) {
    if (clean.course.velocity[from + i] == 0.0) return false;
    changes += part[i] != part[i - 1] ? 1 : 0;
  }
  return size_of(part) > 0.1 * size_of(values) && 4 * changes > length;
}

/// Signals of the clean recordings that may hang; without the position, which is not checked.
template <class Use>
void for_each_signal(Use use) {
  for (std::uint64_t seed = 1; seed <= kRecordings; ++seed) {
    const Clean clean = clean_recording(seed);
    Dice dice(1000 + seed);
    for (std::size_t m = 0; m < clean.recording.measurements.size(); ++m)
      if (clean.recording.measurements[m].signal != Signal::position) use(clean, m, dice);
  }
}

// 223 of 241 are found. The others are rates that were computed from a coarse encoder, or currents
// without noise. The bound is three standard errors of a share lower.
TEST(CleanRecordingsTest, ASensorThatHangsIsFoundInThem) {
  Score score;
  for_each_signal([&](const Clean& clean, std::size_t m, Dice& dice) {
    const std::vector<double>& values = clean.recording.measurements[m].values;
    for (int tries = 0; tries < 50; ++tries) {
      const std::size_t length = 40 + dice.index(200),
                        at = dice.index(clean.course.samples() - length);
      if (!is_busy(clean, values, at, length)) continue;
      Recording stuck = clean.recording;
      for (std::size_t i = at; i < at + length; ++i)
        stuck.measurements[m].values.edit()[i] = values[at];
      const std::size_t found = check_recording(stuck).measurements[m].stuck;
      score.add(found >= length / 2 && found < length + 20);
      return;
    }
  });
  EXPECT_GT(score.of, 200);
  EXPECT_GT(score.share(), 0.87) << score.found << " of " << score.of;
}

// 220 of 247 are found. The others are speeds without a position, and currents, whose noise is
// below their resolution: a constant speed looks alike.
TEST(CleanRecordingsTest, TheEndOfARangeIsFoundInThem) {
  Score score;
  for_each_signal([&](const Clean& clean, std::size_t m, Dice& dice) {
    const std::vector<double>& values = clean.recording.measurements[m].values;
    const auto [low, high] = std::ranges::minmax(values);
    double limit = low + dice.uniform(0.6, 0.9) * (high - low);
    std::size_t beyond = 0, changes = 0;
    for (std::size_t i = 1; i < values.size(); ++i) {
      if (!(values[i] > limit)) continue;
      ++beyond;
      changes += values[i] != values[i - 1] ? 1 : 0;
    }
    if (beyond < 50 || 4 * changes < beyond) return;
    if (const double step = resolution_of(values); step > 0.0)
      limit = step * std::floor(limit / step);
    Recording clipped = clean.recording;
    for (double& x : clipped.measurements[m].values.edit()) x = std::min(x, limit);
    const ValueCheck check = check_recording(clipped).measurements[m];
    score.add(check.clipped > 0 || check.stuck > 0);
  });
  EXPECT_GT(score.of, 200);
  EXPECT_GT(score.share(), 0.83) << score.found << " of " << score.of;
}

// 134 of 142 are found. The bound is two standard errors of a share lower.
TEST(CleanRecordingsTest, AZeroThatMovesIsFoundInThem) {
  Score score;
  for (std::uint64_t seed = 1; seed <= kRecordings; ++seed) {
    const Clean clean = clean_recording(seed);
    Dice dice(3000 + seed);
    const auto m =
        std::ranges::find(clean.recording.measurements, Signal::position, &Measurement::signal);
    if (m == clean.recording.measurements.end()) continue;
    const std::size_t at = 10 + dice.index(clean.course.samples() - 20);
    const double size =
        (dice.chance(0.5) ? 1.0 : -1.0) * dice.uniform(0.1, 0.3) * size_of(m->values);
    Recording displaced = clean.recording;
    const auto index = static_cast<std::size_t>(m - clean.recording.measurements.begin());
    for (std::size_t i = at; i < clean.course.samples(); ++i)
      displaced.measurements[index].values.edit()[i] += size;
    const ValueCheck found = check_recording(displaced).measurements[index];
    score.add(found.jump_at == displaced.times[at] &&
              std::abs(found.jump - size) < 0.1 * std::abs(size));
  }
  EXPECT_GT(score.of, 100);
  EXPECT_GT(score.share(), 0.9) << score.found << " of " << score.of;
}

// Of a speed with noise and next to no rounding: 196 averages and 188 low-passes of 200 are found.
TEST(CleanRecordingsTest, AFilterIsFoundInThem) {
  Score averages, low_passes;
  for (std::uint64_t seed = 1; seed <= kRecordings; ++seed) {
    const Clean clean = clean_recording(seed);
    Dice dice(2000 + seed);
    const double sigma = size_of(clean.course.velocity) * dice.logarithmic(1e-3, 3e-2);
    const std::vector<double> raw = noisy(clean.course.velocity, sigma, dice);
    const std::size_t length = 5 + dice.index(45);
    const auto found = [&](const Filter& filter) {
      Recording recording = with_command(clean.course, clean.course.force);
      add(recording, Signal::velocity, filtered(filter, raw));
      return check_recording(recording).measurements[0].filter;
    };
    const auto average = found({Filter::Kind::moving_average, length, 1, 0.25, false});
    averages.add(average && average->average == length);
    const auto low_pass =
        found({Filter::Kind::butterworth, 1, 1, dice.logarithmic(0.02, 0.15), false});
    low_passes.add(low_pass && low_pass->average == 0);
  }
  EXPECT_GT(averages.share(), 0.94) << averages.found;
  EXPECT_GT(low_passes.share(), 0.88) << low_passes.found;
}

}  // namespace
}  // namespace axisfit::clean
