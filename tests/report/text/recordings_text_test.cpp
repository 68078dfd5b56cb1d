#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "report/text/report_text.h"
#include "tests/report/found.h"

namespace axisfit {
namespace {

TEST(RecordingsTextTest, RunTimesAreSaidToTheirFirstDigit) {
  Job job;
  job.options.threads = 1;
  EXPECT_EQ(on_one_line(run_time_text(job, {.evaluation = 0.01,
                                            .explained = 0.123,
                                            .unexplained = 1.77,
                                            .nothing_missing = 3.4,
                                            .one_effect = 89.0,
                                            .no_effect = 1300.0})),
            "Estimated run time on this machine with 1 thread: 0.1 s if the model explains the "
            "recordings, otherwise 2 s. With --close-loop: 3 s if nothing is missing, 90 s if one "
            "effect is, and 20 min or more if no effect suffices.");
  job.options.threads = 3;
  EXPECT_NE(on_one_line(run_time_text(job, {})).find("with 3 threads: "), std::string::npos);
}

/// What a check found in the first recording of the rubbing mass.
std::vector<RecordingCheck> checks() {
  RecordingCheck check;
  check.sampling = {.samples = 501, .duration = 2.0, .interval = 0.004};
  check.command = {.low = -4.0, .high = 3.0};
  check.switches = 4;
  check.measurements = {{.low = -1.0, .high = 1.25, .noise = 0.002},
                        {.low = -2.0, .high = 2.5, .noise = 0.05}};
  check.measurements[1].resolution = 0.0123;
  return {check};
}

TEST(RecordingsTextTest, DescribesTheInputAndEverySignal) {
  Job job = rubbing_file().job;
  job.recordings[0].measurements[1].sigma = 0.05;
  const std::string text = recordings_text(job, checks());
  expect_narrow(text);
  EXPECT_EQ(on_one_line(text),
            "What the recordings show fitted (fit): 501 samples in 2 s, 250 Hz, no gaps lowest "
            "highest unit sigma noise resolution command -4 3 V 4 switches velocity -1 1.25 m/s "
            "0.002 0.002 none acceleration -2 2.5 m/s^2 0.05 0.05 0.0123 not fitted");
}

TEST(RecordingsTextTest, AFirstLookTellsWhatIsSureAlone) {
  Job job;
  job.recordings.emplace_back().times = std::vector<double>{0.0, 0.001, 0.002};
  EXPECT_EQ(first_look_text(job, {}), "");
  FirstLook look;
  look.mass = {12.0, 0.1};
  look.viscous = {3.0, 1.0};
  look.coulomb = {8.0, 0.5};
  look.constant = {5.0, 0.2};
  look.delay = {0.003, 1e-5};
  look.dissipation = {4.0, 0.5};
  look.largest_mass = 13.0;
  look.unexplained = 0.012;
  look.direction = FirstLook::Direction::along;
  const std::string text = first_look_text(job, look);
  expect_narrow(text);
  EXPECT_EQ(
      on_one_line(text),
      "A first look at the forces of all recordings, by one mass with friction and without a "
      "simulation: M 12.00 +- 0.1 kg, coulomb_friction.F_c 8.00 +- 0.5 N, constant_force.F_0 "
      "-5.00 +- 0.2 N. It leaves 1.2 % of the drive force. The motion follows the drive force "
      "by 3 ms.");
  look.direction = FirstLook::Direction::turned;
  EXPECT_NE(on_one_line(first_look_text(job, look)).find("sign: -1"), std::string::npos);
}

TEST(RecordingsTextTest, CountsGapsAndTellsOfJitter) {
  const Job job = rubbing_file().job;
  std::vector<RecordingCheck> found = checks();
  const auto head = [&] {
    const std::string text = on_one_line(recordings_text(job, found));
    const std::size_t from = text.find("250 Hz");
    return text.substr(from, text.find(" lowest") - from);
  };
  found[0].sampling.gaps = 1;
  found[0].sampling.jitter = 1e-3;
  EXPECT_EQ(head(), "250 Hz, one gap");
  found[0].sampling.gaps = 3;
  found[0].sampling.jitter = 0.0123;
  EXPECT_EQ(head(), "250 Hz, jitter 1.2 %, 3 gaps");
}

TEST(RecordingsTextTest, ARateIsComparedWithItsDerivative) {
  std::vector<RecordingCheck> found = checks();
  found[0].rates = {{Signal::acceleration, Signal::velocity, {1.0025, 1.0}}};
  EXPECT_NE(on_one_line(recordings_text(rubbing_file().job, found)).find("0.0123 1.002 x d/dt"),
            std::string::npos)
      << recordings_text(rubbing_file().job, found);
}

TEST(RecordingsTextTest, AnInputMayBeAReferenceOrAForce) {
  Job job = rubbing_file().job;
  job.recordings[0].command.meaning = Meaning::reference;
  EXPECT_NE(on_one_line(recordings_text(job, checks())).find("position_reference -4 3 m 4 switch"),
            std::string::npos);
  job.recordings[0].command.meaning = Meaning::command;
  job.recordings[0].command_sigma = 0.05;
  job.recordings[0].overrides = {{quantity_index("K_f"), 1.0}};
  EXPECT_NE(on_one_line(recordings_text(job, checks())).find("drive_force -4 3 N 0.05 4 switches"),
            std::string::npos)
      << recordings_text(job, checks());
}

TEST(RecordingsTextTest, ACommandAtItsLimitIsSaidToBe) {
  Job job = rubbing_file().job;
  job.model.controller.gains.limit = 4.0;
  std::vector<RecordingCheck> found = checks();
  found[0].at_maximum = 0.01;
  EXPECT_EQ(recordings_text(job, found).find("at limit"), std::string::npos);
  found[0].at_maximum = 0.25;
  EXPECT_NE(recordings_text(job, found).find("at limit 25 %"), std::string::npos);
  job.model.controller.gains.limit = 4.5;
  EXPECT_EQ(recordings_text(job, found).find("at limit"), std::string::npos);
}

}  // namespace
}  // namespace axisfit
