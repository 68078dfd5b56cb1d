#include "fleet/factory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <stdexcept>

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
  EXPECT_THROW(write_factory(folder.path() + "/a", options), std::runtime_error);  // not empty
}

/// The largest difference of two recordings of one signal.
double difference(const Table& a, const Table& b, const char* signal) {
  const std::vector<double>&x = a.find(signal)->values, &y = b.find(signal)->values;
  EXPECT_EQ(x.size(), y.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) largest = std::max(largest, std::abs(x[k] - y[k]));
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
    for (const auto& entry :
         fs::directory_iterator(folder.path() + "/new/recordings/" + truth.axis)) {
      const std::string name = entry.path().filename().string();
      SCOPED_TRACE(kWearNames[static_cast<int>(truth.wear)] + (" " + name));
      const Table as_new = read_csv(entry.path().string()),
                  worn = read_csv(folder.path() + "/worn/recordings/" + truth.axis + "/" + name);
      const double moved = difference(as_new, worn, "load_position_m");
      ADD_FAILURE() << moved;
    }
  }
  EXPECT_EQ(seen.size(), std::size(kWearNames) - 1);
}

}  // namespace
}  // namespace axisfit
