#include "fit/design/forecast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/fit/example.h"

namespace axisfit {
namespace {

TEST(Forecast, IsWhatTheFitFinds) {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  const Forecast expected = forecast(job, draw_start(job, 0));
  const FitResult fit = estimate(job);
  ASSERT_TRUE(expected.finite && fit.is_usable());
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const double error = fit.parameters[i].uncertainty.standard_error;
    EXPECT_NEAR(expected.uncertainty.parameters[i].standard_error, error, 0.05 * error);
  }
  // What is to be validated shows nothing to a fit.
  EXPECT_EQ(expected.series.size(), 2u);
}

TEST(Forecast, KnowsWhatIsNotSeenAndWhatThatNeeds) {
  const Model<double> truth = motor_axis();
  Job job = two_recordings(truth, truth, {"V_L", "T_p"});
  job.recordings = {recorded(truth, SineMotion{0.4, 2.0, 2.0}, 1.0, 3)};
  const Forecast expected = forecast(job, draw_start(job, 0));
  EXPECT_FALSE(expected.uncertainty.parameters[0].determined);
  EXPECT_TRUE(expected.uncertainty.parameters[1].determined);
  EXPECT_EQ(expected.identifiability.without_influence, std::vector<std::size_t>{0});
  EXPECT_TRUE(expected.sensitivity.row(0).isZero());
  EXPECT_NE(excitation_needed(quantity_list()[quantity_index("V_L")], Joint::prismatic)
                .find("larger step"),
            std::string_view::npos);
}

// A linear machine that starts at rest moves in proportion to its force: the change per e-fold of
// it is the motion itself.
TEST(Forecast, SensitivityToTheForceIsTheMotionInUnitsOfItsNoise) {
  Job job = two_recordings(slide(), slide(), {"K_f"});
  job.recordings = {
      recorded(slide(), fit_motion(), 1.2, 1, {Signal::velocity, Signal::acceleration}, false)};
  const Forecast expected = forecast(job, initial_values(job));
  ASSERT_TRUE(expected.finite);
  ASSERT_EQ(expected.sensitivity.cols(), 2);
  for (std::size_t m = 0; m < 2; ++m) {
    const Measurement& measured = job.recordings[0].measurements[m];
    double squares = 0.0;
    for (const double x : measured.values) squares += x * x;
    const double rms = std::sqrt(squares / static_cast<double>(measured.values.size()));
    EXPECT_NEAR(expected.sensitivity(0, static_cast<Eigen::Index>(m)), rms / measured.sigma,
                1e-6 * rms / measured.sigma);
  }
}

// The readings do not matter, only their noise. Samples through a filter tell less, while a motion
// as slow as this passes it unchanged.
TEST(Forecast, KnowsThatFilteredNoiseIsCorrelated) {
  Job job = two_recordings(slide(), slide(), {"M", "B_a"}, 6.0, {Signal::velocity});
  const auto errors = [&] {
    std::vector<double> list;
    for (const ParameterUncertainty& p : forecast(job, initial_values(job)).uncertainty.parameters)
      list.push_back(p.standard_error);
    return list;
  };
  const std::vector<double> white = errors();
  Measurement& measured = job.recordings[0].measurements[0];
  std::ranges::fill(measured.values.edit(), 0.0);
  EXPECT_EQ(errors(), white);
  measured.filter = {.kind = Filter::Kind::moving_average, .length = 9};
  const double larger = std::sqrt(noise_correlation_time(measured));
  ASSERT_GT(larger, 2.0);
  const std::vector<double> filtered = errors();
  for (std::size_t i = 0; i < white.size(); ++i)
    EXPECT_NEAR(filtered[i], larger * white[i], 0.05 * larger * white[i]);
}

TEST(Forecast, IsNoneWhereTheSimulationDoesNotFinish) {
  const Job job = two_recordings(slide(), slide(), {"M", "B_a"});
  const Forecast expected = forecast(job, {std::nan(""), 30.0});
  EXPECT_FALSE(expected.finite);
  EXPECT_TRUE(expected.uncertainty.parameters.empty());
  EXPECT_TRUE(expected.series.empty());
}

TEST(ExcitationNeeded, IsSaidInTheWordsOfTheMachine) {
  const auto needs = [](const char* name, Vocabulary vocabulary) {
    return excitation_needed(quantity_list()[quantity_index(name)], vocabulary);
  };
  EXPECT_EQ(needs("F_s", Joint::prismatic),
            "the arm to come to rest and break away: slow motion with reversals");
  EXPECT_EQ(needs("F_s", Joint::revolute),
            "the joint to come to rest and break away: slow motion with reversals");
  EXPECT_EQ(needs("V_L", Joint::revolute), needs("V_L", Joint::prismatic));
  // That of an effect is its own.
  EXPECT_EQ(needs("stroke_spring.k_s", Joint::prismatic), motions::kWholeStroke);
  EXPECT_EQ(needs("stroke_spring.k_s", Joint::revolute),
            "motion in both directions over the whole travel, at several speeds");
  EXPECT_EQ(needs("velocity.bias", Joint::prismatic), "");
}

}  // namespace
}  // namespace axisfit
