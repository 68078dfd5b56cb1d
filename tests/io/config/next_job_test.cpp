#include "io/config/next_job.h"

#include <gtest/gtest.h>

#include <string>

#include "io/config/axis_file.h"
#include "tests/apps/files.h"
#include "tests/apps/fit_job.h"

namespace axisfit {
namespace {

/// The job on the rubbing mass, whose friction is not declared.
class NextJobTest : public ::testing::Test {
 protected:
  NextJobTest() { write_rubbing_mass(folder_); }

  /// The job that goes on from a result.
  Job job_after(const JobFile& file, const Job& reached) const {
    const std::string text = next_job_text(file, reached, folder_.path("job.yaml"), "",
                                           folder_.path(), "plain.yaml", "Goes on.");
    return read_job_file(folder_.write("next.yaml", text)).job;
  }

  TempFolder folder_;
  const std::string job_ = rubbing_job();
};

TEST_F(NextJobTest, GoesOnWithTheRolesOfTheResult) {
  const JobFile file = read_job_file(folder_.write("job.yaml", job_));
  const auto roles_after = [&](const Job& reached) {
    std::string roles;
    for (const Recording& r : job_after(file, reached).recordings)
      roles += r.role == Role::fit ? "fit " : "validate ";
    return roles;
  };
  EXPECT_EQ(roles_after(file.job), "fit validate ");
  EXPECT_EQ(roles_after(*with_exchanged_roles(file.job)), "validate fit ");
}

TEST_F(NextJobTest, KeepsWhatDiffersInOneRecording) {
  const JobFile file =
      read_job_file(folder_.write("job.yaml", replaced(job_, "M: {initial: 10 kg}, ", "")));
  Job reached = file.job;
  FreeParameter own = free_parameter("M", 20.0);
  own.recording = 0;
  reached.free.push_back(own);
  const std::vector<FreeParameter> free = job_after(file, reached).free;
  EXPECT_NE(std::ranges::find(free, own.id(), &FreeParameter::id), free.end());
}

TEST_F(NextJobTest, GoesOnTrackingIfTheSearchDid) {
  for (const char* fit : {"", "fit: {observer: none, horizon: 2 s, seed: 7}\n",
                          "fit: {initial_observer_gain: 100 1/s, seed: 7}\n"}) {
    const JobFile file = read_job_file(folder_.write("job.yaml", job_ + fit));
    const FitOptions again = job_after(file, file.job).options;
    EXPECT_EQ(again.criterion, file.job.options.criterion);
    EXPECT_EQ(again.continuation, file.job.options.continuation);
    Job reached = file.job;
    reached.options.criterion = Tracking{25.0};
    const FitOptions next = job_after(file, reached).options;
    EXPECT_EQ(next.criterion, reached.options.criterion);
    EXPECT_EQ(next.seed, file.job.options.seed);
  }
  // A criterion that is chosen is chosen anew.
  const JobFile file = read_job_file(folder_.write("job.yaml", job_ + "fit: {horizon: auto}\n"));
  Job reached = file.job;
  reached.options.criterion = Tracking{};
  EXPECT_TRUE(job_after(file, reached).choose_criterion);
}

TEST_F(NextJobTest, FreesWhatTheEffectsBrought) {
  const JobFile file = read_job_file(folder_.write("job.yaml", job_));
  Job reached = file.job;
  reached.model.structure.effects.set(*effect_named("coulomb_friction"));
  FreeParameter friction = free_parameter("coulomb_friction.F_c", 6.0);
  friction.lower = 0.0;
  friction.upper = 50.0;
  reached.free.push_back(friction);
  Rig rig = file.rig;
  rig.model = reached.model;
  *members(rig.model)[quantity_index("M")] = 4.5;
  *members(rig.model)[friction.quantity] = 6.0;
  folder_.write("fitted.yaml", format_axis_file(rig, ""));
  const std::string text = next_job_text(file, reached, folder_.path("job.yaml"), "",
                                         folder_.path(), "fitted.yaml", "Goes on from x.");
  EXPECT_TRUE(text.starts_with("# Goes on from x.\naxis: fitted.yaml\n")) << text;
  const Job next = read_job_file(folder_.write("next.yaml", text)).job;
  ASSERT_EQ(next.free.size(), 3u);
  EXPECT_EQ(next.free[0].initial, 4.5) << "that of the axis, not of the job before";
  EXPECT_EQ(next.free[2].quantity, friction.quantity);
  EXPECT_EQ(next.free[2].initial, 6.0);
  EXPECT_EQ(next.free[2].lower, 0.0);
  EXPECT_EQ(next.free[2].upper, 50.0);
}

TEST_F(NextJobTest, NamesFilesFromWhereItIs) {
  const JobFile file = read_job_file(folder_.write("job.yaml", job_));
  const auto text = [&](const std::string& data, const std::string& to) {
    return next_job_text(file, file.job, folder_.path("job.yaml"), data, to, "a.yaml", "x");
  };
  EXPECT_NE(text("", folder_.path("results/one")).find("file: ../../fitted.csv"),
            std::string::npos);
  EXPECT_NE(text(folder_.path("data"), folder_.path("results")).find("file: ../data/judged.csv"),
            std::string::npos);
}

}  // namespace
}  // namespace axisfit
