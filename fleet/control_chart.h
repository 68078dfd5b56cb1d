// Cumulative sums of standard normal numbers, which tell early that their mean has moved.
//
//   C+ = max(0, C+ + z - k),  C- = max(0, C- - z - k),  alarm at C >= h
//
// E. S. Page, Biometrika 41 (1954). The mean number of nights up to a false alarm is that of a
// Markov chain (D. Brook and D. A. Evans, Biometrika 59 (1972)).
#pragma once

#include <cstddef>

namespace axisfit {

/// Half the shift that is looked for, in standard deviations.
inline constexpr double kChartReference = 0.75;

/// Mean number of nights up to a false alarm of a chart to both sides, with independent standard
/// normal numbers.
double mean_run_length(double threshold, double reference = kChartReference);

/// The threshold h with that mean number of nights, at least 2.
double threshold_for(double run_length, double reference = kChartReference);

class Cusum {
 public:
  explicit Cusum(double threshold) : threshold_(threshold) {}

  /// One more night. Whether there is an alarm; direction() and nights_since() then tell more.
  bool add(double z);
  void restart() { *this = Cusum(threshold_); }
  /// +1 or -1
  int direction() const { return up_.sum >= down_.sum ? 1 : -1; }
  /// How many nights, the last one included, the sum has been above zero.
  std::size_t nights_since() const { return direction() > 0 ? up_.nights : down_.nights; }

 private:
  struct Side {
    double sum = 0.0;
    std::size_t nights = 0;
    void add(double z);
  };

  double threshold_;
  Side up_, down_;
};

}  // namespace axisfit
