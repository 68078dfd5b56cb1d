#include "base/suggest.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace axisfit {
namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  // Not std::tolower: the answer must not depend on the locale.
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

// Damerau-Levenshtein distance in its "optimal string alignment" form, where swapped neighbours
// are not edited again. Keeps the three rows of the table that the recurrence looks at.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> two_above(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> current(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) current[j] = j;

  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(two_above, above);
    std::swap(above, current);
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      current[j] = std::min({replace, above[j] + 1, current[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) current[j] = std::min(current[j], two_above[j - 2] + 1);
    }
  }
  return current[b.size()];
}

}  // namespace

std::string closest_match(std::string_view name, std::span<const std::string> candidates) {
  const std::string folded = lower(name);
  const std::string* best = nullptr;
  std::pair<std::size_t, std::size_t> best_distance;  // case ignored, then case respected
  for (const std::string& candidate : candidates) {
    const std::size_t folded_distance = edit_distance(folded, lower(candidate));
    const std::size_t longer = std::max(name.size(), candidate.size());
    // The second limit only bites for names of up to three characters, where two edits can turn
    // anything into anything.
    if (folded_distance > std::max<std::size_t>(2, longer / 3)) continue;
    if (2 * folded_distance > longer) continue;

    const std::pair distance(folded_distance, edit_distance(name, candidate));
    if (best == nullptr || distance < best_distance) {
      best = &candidate;
      best_distance = distance;
    }
  }
  return best == nullptr ? std::string() : *best;
}

}  // namespace axisfit
