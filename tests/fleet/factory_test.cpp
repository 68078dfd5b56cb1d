#include "fleet/factory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "io/recording/csv.h"
#include "tests/apps/files.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

TEST(Factory, IsTheSameEveryTime) {
  TempFolder folder;
  FactoryOptions options;
  options.axes = 2;
  options.nights = 3;
  options.missing = 0.0;
  write_factory(folder.path() + "/a", options);
  const ThreadPool pool(2);
  write_factory(folder.path() + "/b", options);
  for (const auto& entry : fs::recursive_directory_iterator(folder.path() + "/a"))
    if (entry.is_regular_file()) {
      const std::string name = fs::relative(entry.path(), folder.path() + "/a").string();
      EXPECT_EQ(folder.read("a/" + name), folder.read("b/" + name)) << name;
    }
  try {
    write_factory(folder.path() + "/a", options);
    ADD_FAILURE() << "a second factory in the same folder";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("is not empty"), std::string::npos) << error.what();
  }
}

/// The largest difference of two recordings, m, whatever the signal.
double difference(const Table& a, const Table& b) {
  double largest = 0.0;
  for (const char* signal : {"position_m", "load_position_m"}) {
    const std::vector<double>&x = a.find(signal)->values, &y = b.find(signal)->values;
    EXPECT_EQ(x.size(), y.size());
    for (std::size_t k = 0; k < x.size(); ++k) largest = std::max(largest, std::abs(x[k] - y[k]));
  }
  return largest;
}

// The same draws with and without wear: all that differs is what wears.
TEST(Factory, WearChangesTheMotionFromItsNightOn) {
  TempFolder folder;
  FactoryOptions options;
  options.axes = 20;
  options.nights = 3;
  options.missing = options.wrong = 0.0;
  options.worn = 0.0;
  write_factory(folder.path() + "/new", options);
  options.worn = 1.0;
  const std::vector<AxisTruth> truths = write_factory(folder.path() + "/worn", options);
  std::set<Wear> seen;
  for (const AxisTruth& truth : truths) {
    seen.insert(truth.wear);
    for (std::size_t night = 0; night < options.nights; ++night) {
      const std::string name =
          "/recordings/" + truth.axis + "/2026-09-0" + std::to_string(night + 1) + ".csv";
      SCOPED_TRACE(kWearNames[static_cast<int>(truth.wear)] + (" " + name));
      const double moved = difference(read_csv(folder.path() + "/new" + name),
                                      read_csv(folder.path() + "/worn" + name));
      if (night < truth.since) {
        EXPECT_EQ(moved, 0.0);
      } else {
        EXPECT_GT(moved, 5e-6);  // five times the noise
        EXPECT_LT(moved, 0.05);  // of a stroke of 0.3 m
      }
    }
  }
  EXPECT_EQ(seen.size(), std::size(kWearNames) - 1);
}

}  // namespace
}  // namespace axisfit
