// Two causes that hide each other, on a mass that is simulated here and not by the project.
#include "fit/search/pairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "fit/criterion/gains.h"
#include "fit/search/catalogue.h"
#include "tests/fit/search/selection.h"

namespace axisfit {
namespace {

constexpr double kMass = 20.0, kViscous = 30.0;
constexpr double kSample = 2e-3;
constexpr int kSamples = 1500;

/// Forces per unit of two channels that go up and down together but for a small difference, which
/// is all that the mass feels where they are opposite.
struct Causes {
  double one = 0.0, other = 0.0;
};

std::array<double, 2> channels_at(double t, double phase) {
  const double both = std::sin(31.0 * t + phase) + std::sin(13.0 * t + 2.0 * phase),
               difference = std::sin(47.0 * t + phase) - std::cos(23.0 * t);
  return {both, both + 0.15 * difference};
}

Recording recorded_with(const Causes& causes, double phase, std::uint64_t seed) {
  Recording r;
  Normal noise(seed);
  double y = 0.0, v = 0.0;
  std::array<std::vector<double>, 2> channels;
  std::vector<double> force, place, speed;
  for (int k = 0; k < kSamples; ++k) {
    const double t = k * kSample;
    const double u = 60.0 * std::sin(5.0 * t + phase) + 40.0 * std::sin(11.0 * t);
    const std::array<double, 2> c = channels_at(t, phase);
    r.times.edit().push_back(t);
    force.push_back(u);
    place.push_back(y + usual_noise(Signal::position) * noise());
    speed.push_back(v + usual_noise(Signal::velocity) * noise());
    for (std::size_t i = 0; i < 2; ++i) channels[i].push_back(c[i]);
    // Within a sample the command is held and the channels go straight.
    const std::array<double, 2> next = channels_at(t + kSample, phase);
    constexpr int kParts = 50;
    for (int part = 0; part < kParts; ++part) {
      const double at = (part + 0.5) / kParts;
      const double push = u + causes.one * (c[0] + at * (next[0] - c[0])) +
                          causes.other * (c[1] + at * (next[1] - c[1]));
      const double a = (push - kViscous * v) / kMass, h = kSample / kParts;
      y += h * (v + 0.5 * h * a);
      v += h * a;
    }
  }
  r.command = schedule_from_samples(r.times, force, Hold::zero_order);
  for (const auto& [signal, values] :
       {std::pair(Signal::position, place), std::pair(Signal::velocity, speed)}) {
    Measurement& m = r.measurements.emplace_back();
    m.signal = signal;
    m.values = values;
    m.sigma = usual_noise(signal);
    m.noise = NoiseSource::given;
  }
  for (const std::vector<double>& values : channels) r.channels.emplace_back(values);
  return r;
}

Job job_with(const Causes& causes) {
  Job job;
  job.model = driven_mass(kMass);
  job.model.axis.B_a = kViscous;
  ChannelList channels{{"one", "V", 0.0}, {"other", "V", 0.0}};
  job.model.structure.channels = kept(channels);
  job.options.threads = 1;
  job.options.criterion = Tracking{30.0};
  job.recordings = {recorded_with(causes, 0.0, 1), recorded_with(causes, 0.7, 2)};
  job.recordings[1].name = "validate";
  job.recordings[1].role = Role::validate;
  for (const char* name : {"M", "B_a"})
    job.free.push_back(free_parameter(name, *members(job.model)[quantity_index(name)]));
  return job;
}

std::vector<ScoredPair> pairs_in(const FittedModel& model, const Shortlist& list) {
  return score_pairs(model, list.observer_gains, list.promises, {});
}

FittedModel fitted(const Job& job) { return {"", job, estimate(job)}; }
Shortlist list_of(const FittedModel& model) {
  return shortlist(model.job, values_of(model.fit), score_gains(model.job), false);
}

constexpr Causes kOpposite{12.0, -12.0};

TEST(Pairs, AreTwoThatGainTogetherWhatNeitherDoes) {
  const FittedModel model = fitted(job_with(kOpposite));
  const Shortlist list = list_of(model);
  const std::vector<ScoredPair> pairs = pairs_in(model, list);
  ASSERT_FALSE(pairs.empty());
  const ScoredPair& best = pairs.front();
  std::map<std::string, double> strengths;
  for (const Scored* one : {&best.first, &best.second}) {
    strengths[one->hypothesis->name] = one->own.strengths[0];
    EXPECT_GT(best.gain, 10.0 * list.promised_by(*one->hypothesis).value());
  }
  ASSERT_EQ(strengths.size(), 2u);
  EXPECT_NEAR(strengths["channel_force.one"], kOpposite.one, 1.0);
  EXPECT_NEAR(strengths["channel_force.other"], kOpposite.other, 1.0);
}

TEST(Pairs, PassWhereEachIsNeededBesideTheOther) {
  const FittedModel model = fitted(job_with(kOpposite));
  const auto found = try_pair(model, pairs_in(model, list_of(model)).front(), {});
  ASSERT_TRUE(found);
  for (const auto& [name, truth] : {std::pair("channel_force.one", kOpposite.one),
                                    std::pair("channel_force.other", kOpposite.other)}) {
    const auto& all = found->second.fit.parameters;
    const auto p = std::ranges::find_if(all, [&, name = name](const ParameterResult& one) {
      return found->second.job.entry(one.id.quantity).name == name;
    });
    ASSERT_NE(p, all.end()) << name;
    EXPECT_NEAR(p->value, truth, 4.0 * p->uncertainty.standard_error) << name;
  }
  EXPECT_GT(found->first.gain.fit_gain, 100.0);
  EXPECT_GT(found->second.gain.fit_gain, 100.0);
}

// Each explains a part of its own, and may fail on what the other would explain.
TEST(Pairs, AreTwoThatAddUp) {
  Model<double> truth = slide();
  hidden_effect_named("coulomb_friction").put_into(truth);
  hidden_effect_named("stroke_spring").put_into(truth);
  const FittedModel model = fitted(two_recordings(truth, slide(), {"M", "B_a"}));
  const std::vector<ScoredPair> pairs = pairs_in(model, list_of(model));
  EXPECT_LE(pairs.size(), 4u);
  EXPECT_TRUE(std::ranges::is_sorted(pairs, std::greater{}, &ScoredPair::is_hidden));
  bool is_found = false;
  for (const ScoredPair& pair : pairs) {
    const std::set<std::string> both{pair.first.hypothesis->name, pair.second.hypothesis->name};
    if (both != std::set<std::string>{"coulomb_friction", "stroke_spring"}) continue;
    is_found = true;
    EXPECT_FALSE(pair.is_hidden);
    EXPECT_TRUE(try_pair(model, pair, {}));
  }
  EXPECT_TRUE(is_found);
}

TEST(Pairs, AreNoneWhereOneCauseIsAll) {
  for (const Causes& causes : {Causes{}, Causes{0.5, 0.0}}) {
    const FittedModel model = fitted(job_with(causes));
    for (const ScoredPair& pair : pairs_in(model, list_of(model)))
      EXPECT_FALSE(try_pair(model, pair, {}))
          << pair.first.hypothesis->name << " and " << pair.second.hypothesis->name;
  }
}

TEST(Pairs, AreFoundByASearch) {
  const EffectSelection selection = close(job_with(kOpposite));
  EXPECT_THAT(accepted(selection),
              ::testing::ElementsAre("channel_force.one", "channel_force.other"));
  EXPECT_TRUE(selection.explained);
  for (const char* name : {"channel_force.one", "channel_force.other"}) {
    ASSERT_NE(trial_of(selection, name), nullptr);
    EXPECT_EQ(trial_of(selection, name)->reason, Reason::explains_beside) << name;
  }
}

}  // namespace
}  // namespace axisfit
