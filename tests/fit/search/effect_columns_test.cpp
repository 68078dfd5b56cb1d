#include "fit/search/effect_columns.h"

#include <gtest/gtest.h>

#include <iostream>

#include "fit/search/catalogue.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

/// The derivatives with respect to everything that a setting frees, by a simulation of its own.
Eigen::MatrixXd by_itself(const Job& job, const EffectSetting& setting, double rate) {
  const Job with = with_hypothesis(job, *setting.hypothesis, {}, setting.own, !setting.with_shapes);
  const ParameterSpace space(with);
  std::vector<double> values;
  for (const FreeParameter& p : with.free) values.push_back(p.initial);
  const Eigen::VectorXd u = space.internal(values);
  Eigen::MatrixXd columns = linearize(with, space, u, rate).jacobian;
  for (std::size_t i = 0; i < space.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (space[i].scale != Scale::logarithmic) columns.col(k) /= space.slope(i, u[k]);
  }
  return columns;
}

class EffectColumnsOf : public testing::TestWithParam<const char*> {
 protected:
  EffectColumnsOf() {
    const std::string axis = GetParam();
    Model<double> model = axis == "motor" ? motor_axis() : axis == "rack" ? paper_axis() : slide();
    if (axis == "sticking slide") add_effect<CoulombFriction>(model).F_c = 12.0;
    job_ = two_recordings(model, model, {});
    SearchScales scales{-0.05, 0.2, 1.0, -1.0, 1.0, 0.0, 1.2, 1e-3};
    scales.periods = scales.drive_periods = {0.05};
    hypotheses_ = catalogue(job_, scales);
  }

  /// Every column within `tolerance` of its length, or of what a newton does to three samples (of a
  /// strength per newton transmitted, all that are): the first, of an arm at rest, and those beside
  /// a reversal.
  void expect_alike(const EffectSetting& setting, const Eigen::MatrixXd& found, double rate,
                    double tolerance) const {
    const Eigen::MatrixXd expected = by_itself(job_, setting, rate);
    ASSERT_EQ(found.rows(), expected.rows()) << setting.hypothesis->name;
    ASSERT_EQ(found.cols(), expected.cols()) << setting.hypothesis->name;
    double samples = 3.0 / (job_.model.axis.M * usual_noise(Signal::acceleration));
    if (setting.hypothesis->name == "stribeck_load_friction") samples *= largest_force();
    for (Eigen::Index k = 0; k < expected.cols(); ++k)
      EXPECT_LE((found.col(k) - expected.col(k)).norm(),
                tolerance * expected.col(k).norm() + samples)
          << setting.hypothesis->name << ", column " << k;
  }

  /// That the transmission carries, N.
  double largest_force() const {
    const auto largest =
        std::ranges::max_element(job_.recordings.front().find(Signal::acceleration)->values, {},
                                 [](double a) { return std::abs(a); });
    return job_.model.axis.M * std::abs(*largest);
  }

  Job job_;
  std::vector<Hypothesis> hypotheses_;
};

// Between two samples a force is taken as its mean: where it jumps, as friction does at a reversal,
// the response is off for as long.
TEST_P(EffectColumnsOf, AreThoseOfASimulationWithEachEffect) {
  for (const double rate : {0.0, 30.0}) {
    const EffectColumns columns(job_, rate, {});
    std::vector<EffectSetting> settings;
    for (const Hypothesis& c : hypotheses_)
      if (c.probes.empty())
        for (const auto& shapes : c.settings) settings.push_back({&c, {c.neutral, shapes}});
    ASSERT_GT(settings.size(), 40u);
    const std::vector<Eigen::MatrixXd> found = columns.derivatives(settings);
    for (std::size_t i = 0; i < settings.size(); ++i)
      expect_alike(settings[i], found[i], rate, 0.1);
  }
}

TEST_P(EffectColumnsOf, OfOneRecordingAreNothingInTheOthers) {
  job_.recordings[1].role = Role::fit;
  SearchScales scales{-0.05, 0.2, 1.0, -1.0, 1.0, 0.0, 1.2, 1e-3};
  std::vector<Hypothesis> own = catalogue(job_, scales);
  std::erase_if(own, [](const Hypothesis& c) { return !c.recording; });
  ASSERT_GE(own.size(), 4u);
  const EffectColumns columns(job_, 30.0, {});
  std::vector<EffectSetting> settings;
  for (const Hypothesis& c : own) settings.push_back({&c, {c.neutral, c.settings.front()}});
  const std::vector<Eigen::MatrixXd> found = columns.derivatives(settings);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    expect_alike(settings[i], found[i], 30.0, 0.1);
    const Eigen::Index half = found[i].rows() / 2;
    const bool is_first = own[i].recording == 0u;
    EXPECT_EQ(found[i].topRows(half).isZero(0.0), !is_first) << own[i].name;
    EXPECT_EQ(found[i].bottomRows(half).isZero(0.0), is_first) << own[i].name;
  }
}

TEST_P(EffectColumnsOf, LackWhatTheStatesOfWindowsCouldMake) {
  job_.options.criterion = Windows{0.3};
  for (Recording& r : job_.recordings) r.initial_state = InitialState::data;
  const EffectColumns columns(job_, 0.0, {});
  std::vector<EffectSetting> settings;
  for (const Hypothesis& c : hypotheses_)
    if (c.probes.empty()) settings.push_back({&c, {c.neutral, c.settings.front()}});
  const std::vector<Eigen::MatrixXd> found = columns.derivatives(settings);
  for (std::size_t i = 0; i < settings.size(); ++i) expect_alike(settings[i], found[i], 0.0, 0.1);
}

TEST_P(EffectColumnsOf, TellWhatTheShapesDo) {
  const EffectColumns columns(job_, 30.0, {});
  std::vector<EffectSetting> settings;
  for (const Hypothesis& c : hypotheses_)
    if (c.probes.empty() && !c.estimated_shapes().empty())
      settings.push_back(
          {&c,
           {std::vector<double>(c.strengths.size(), 1e-3), c.settings[1 % c.settings.size()]},
           true});
  ASSERT_GT(settings.size(), 3u);
  const std::vector<Eigen::MatrixXd> found = columns.derivatives(settings);
  for (std::size_t i = 0; i < settings.size(); ++i) expect_alike(settings[i], found[i], 30.0, 0.2);
}

INSTANTIATE_TEST_SUITE_P(EveryAxis, EffectColumnsOf,
                         testing::Values("slide", "sticking slide", "motor", "rack"),
                         [](const auto& one) {
                           std::string name = one.param;
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

}  // namespace
}  // namespace axisfit
