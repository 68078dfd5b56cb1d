// Consecutive parts of a recording: the windows that a fit simulates, the blocks that are held out,
// the stretches that are compared.
#pragma once

#include <cstddef>

namespace axisfit {

/// So many samples, in order, in parts of equal length to within a sample.
class Partition {
 public:
  /// At least one part.
  Partition(std::size_t samples, std::size_t parts) : samples_(samples), parts_(parts) {}

  std::size_t parts() const { return parts_; }
  /// The first sample of a part; behind the last part, the number of samples.
  std::size_t first(std::size_t part) const { return part * samples_ / parts_; }
  std::size_t size(std::size_t part) const { return first(part + 1) - first(part); }

 private:
  std::size_t samples_, parts_;
};

}  // namespace axisfit
