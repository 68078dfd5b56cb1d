#include "tests/apps/fit_job.h"
#include "tests/apps/killing.h"

namespace axisfit {
namespace {

TEST(KillingSlowTest, TwoHundredTimesAMultistart) {
  const TempFolder folder;
  write_recordings(folder);
  folder.write("job.yaml", fit_job("{starts: 8}"));
  Killing(folder, "job.yaml").kill(200);
}

TEST(KillingSlowTest, TwoHundredTimesALoop) {
  const TempFolder folder;
  write_rubbing_mass(folder);
  folder.write("job.yaml", rubbing_job());
  Killing(folder, "job.yaml --close-loop").kill(200);
}

}  // namespace
}  // namespace axisfit
