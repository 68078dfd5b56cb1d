// Many fits in one process: its memory does not grow.
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <fstream>
#include <string>

#include "fit/run.h"
#include "io/config/job_file.h"
#include "report/html/report_page.h"
#include "report/result_json.h"
#include "report/text/report_text.h"
#include "tests/apps/files.h"
#include "tests/apps/fit_job.h"

namespace axisfit {
namespace {

/// Bytes in memory, and of these the ones that are allocated, after what is free was given back.
struct Memory {
  double resident = 0.0, allocated = 0.0;

  static Memory now() {
    malloc_trim(0);
    double pages = 0.0, resident = 0.0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return {resident * static_cast<double>(sysconf(_SC_PAGESIZE)),
            static_cast<double>(mallinfo2().uordblks)};
  }
};

TEST(Soak, AThousandFitsTakeNoMoreMemoryThanTwoHundred) {
  const TempFolder folder;
  write_recordings(folder);
  write_rubbing_mass(folder);
  const std::string single = folder.write("single.yaml", fit_job());
  const std::string several = folder.write("several.yaml", fit_job("{starts: 3}"));
  const std::string rubbing = folder.write("rubbing-job.yaml", rubbing_job());
  const std::string wrong = folder.write("wrong.yaml", fit_job("{start: 3}"));

  // The whole of fit-params but for its command line.
  const auto fit = [](const std::string& job, bool select_effects = false) {
    const RunResult run_result = run(read_job_file(job).job, {.select_effects = select_effects});
    ASSERT_TRUE(run_result.fit().is_usable());
    const std::string json = result_json(run_result).dump(2), text = report_text(run_result),
                      csv = residuals_csv(run_result.job(), run_result.fit(), run_result.diagnosis),
                      page = report_page(run_result, {"fit-params", job, "", "", ""});
    ASSERT_FALSE(json.empty() || text.empty() || csv.empty() || page.empty());
  };
  Memory early;
  for (int done = 0; done < 1000; ++done) {
    if (done == 200) early = Memory::now();
    if (done % 50 == 0)
      fit(rubbing, true);
    else
      fit(done % 2 == 0 ? single : several);
    EXPECT_THROW(read_job_file(wrong), ConfigError);
  }
  const Memory late = Memory::now();
  RecordProperty("resident_after_200", std::to_string(early.resident));
  RecordProperty("resident_after_1000", std::to_string(late.resident));
  // A hundred bytes per fit would be found among what is allocated. The threads' own pages come
  // and go.
  EXPECT_LT(late.allocated - early.allocated, 80e3);
  EXPECT_LT(late.resident - early.resident, 2e6);
}

}  // namespace
}  // namespace axisfit
