// A simulated factory: many axes that make the same motion every night, some of which wear.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace axisfit {

/// What happens to an axis.
enum class Wear {
  none,
  friction,  ///< B_a and Coulomb friction grow at once, by 5 %
  grease,    ///< B_a grows slowly, by 1 % a night
  play,      ///< the play of the transmission opens by 10 um
  bearing,   ///< a force that is periodic in the position appears
  belt,      ///< the transmission becomes twice as soft
  sensor,    ///< the gain of the load's scale changes by 1e-3
};
inline constexpr const char* kWearNames[]{"none",    "friction", "grease", "play",
                                          "bearing", "belt",     "sensor"};

struct FactoryOptions {
  std::size_t axes = 20, nights = 30;
  std::uint64_t seed = 1;
  double worn = 0.3;      ///< share of the axes that wear, from a night in the second half on
  double missing = 0.03;  ///< share of the nights without a recording
  double wrong = 0.005;   ///< share of the recordings that are damaged
};

/// Of one axis.
struct AxisTruth {
  std::string axis;
  Wear wear = Wear::none;
  std::size_t since = 0;  ///< night, from 0
};

/// Writes the factory into a folder: axis.yaml, night.yaml, fleet.yaml, truth.csv and
/// recordings/AXIS/NIGHT.csv. The same for the same options on every machine. Uses the threads of
/// the pool. Throws std::runtime_error where that cannot be written, or the folder is not empty.
std::vector<AxisTruth> write_factory(const std::string& folder, const FactoryOptions& options);

}  // namespace axisfit
