#include "fit/data/validation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <stdexcept>

#include "fit/run.h"
#include "tests/fit/example.h"

namespace axisfit {
namespace {

using Rule = JobFault::Rule;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Nobody's motion, of 200 samples in 10 s.
Recording recording(const char* name, double frequency) {
  Recording r;
  r.name = name;
  std::vector<double> times, position, velocity;
  for (int i = 0; i < 200; ++i) {
    times.push_back(0.05 * i);
    position.push_back(std::sin(frequency * i));
    velocity.push_back(std::cos(frequency * i));
  }
  r.times = times;
  r.command = {{0.0, 1.0}, {0.0, 2.0}};
  for (const auto& [signal, values] :
       {std::pair(Signal::position, position), std::pair(Signal::velocity, velocity)}) {
    Measurement& m = r.measurements.emplace_back();
    m.signal = signal;
    m.values = values;
    m.sigma = 1e-3;
  }
  return r;
}

Job good_job() {
  Job job;
  job.model = slide();
  job.recordings = {recording("fit", 0.3), recording("check", 0.4)};
  job.recordings[1].role = Role::validate;
  job.free = {free_parameter("M", 10.0), free_parameter("B_a", 20.0)};
  return job;
}

std::size_t index(const char* name) { return quantity_index(name); }

struct Broken {
  Rule rule;
  std::function<void(Job&)> make;
};

/// A case or more of every rule.
std::vector<Broken> broken() {
  const auto of_recording = [](Rule rule, std::function<void(Recording&)> make) {
    return Broken{rule, [make](Job& job) { make(job.recordings[0]); }};
  };
  const auto of_measurement = [](Rule rule, std::function<void(Measurement&)> make) {
    return Broken{rule, [make](Job& job) { make(job.recordings[0].measurements[1]); }};
  };
  const auto of_parameter = [](Rule rule, std::function<void(FreeParameter&)> make) {
    return Broken{rule, [make](Job& job) { make(job.free[0]); }};
  };
  const auto of_fixed = [](Rule rule, std::function<void(Job&)> make) {
    return Broken{rule, [make](Job& job) {
                    job.options.criterion = Tracking{};
                    make(job);
                  }};
  };
  return {
      {Rule::options, [](Job& job) { job.options.starts = 0; }},
      {Rule::options, [](Job& job) { job.options.step = kNan; }},
      {Rule::limits,
       [](Job& job) {
         job.limits.lowest = 1.0;
         job.limits.highest = 0.0;
       }},
      {Rule::limits, [](Job& job) { job.limits.speed = 0.0; }},
      {Rule::guessed, [](Job& job) { job.guessed = {100'000}; }},
      {Rule::model,
       [](Job& job) {
         job.model = paper_axis();
         job.model.axis.J_m = 0.0;
       }},
      {Rule::model,
       [](Job& job) {
         job.model = paper_axis();
         job.recordings[0].overrides = {{index("J_m"), 0.0}};
       }},
      {Rule::value, [](Job& job) { job.model.axis.K_f = 0.0; }},
      {Rule::value, [](Job& job) { job.model.axis.F_s = kNan; }},
      {Rule::fitted_recording, [](Job& job) { job.recordings[0].role = Role::validate; }},
      {Rule::fitted_recording, [](Job& job) { job.recordings.clear(); }},
      {Rule::free_quantity, [](Job& job) { job.free.clear(); }},
      of_recording(Rule::degrees_of_freedom,
                   [](Recording& r) {
                     r.held_out.assign(200, true);
                     r.held_out[0] = false;
                   }),
      of_recording(Rule::name, [](Recording& r) { r.name = "check"; }),
      of_recording(Rule::times, [](Recording& r) { r.times.edit()[7] = r.times[6]; }),
      of_recording(Rule::times, [](Recording& r) { r.times.edit()[199] = INFINITY; }),
      of_recording(Rule::times,
                   [](Recording& r) {
                     r.times = {0.0, 1.0};
                     for (Measurement& m : r.measurements) m.values = {0.0, 1.0};
                   }),
      of_recording(Rule::command, [](Recording& r) { r.command = {}; }),
      of_recording(Rule::command, [](Recording& r) { r.command.values.edit()[1] = kNan; }),
      of_recording(Rule::command, [](Recording& r) { r.command.values.edit().pop_back(); }),
      of_recording(Rule::command, [](Recording& r) { r.command.times.edit()[1] = 0.0; }),
      of_recording(Rule::command, [](Recording& r) { r.command_sigma = -1.0; }),
      of_recording(Rule::reference, [](Recording& r) { r.command.meaning = Meaning::reference; }),
      of_recording(Rule::channels, [](Recording& r) { r.channels = {r.times}; }),
      {Rule::channels,
       [](Job& job) { job.model.structure.channels = kept(ChannelList(kChannels + 1)); }},
      of_recording(Rule::held_out, [](Recording& r) { r.held_out = {true}; }),
      of_recording(Rule::set_quantity,
                   [](Recording& r) {
                     r.overrides = {{100'000, 1.0}};
                   }),
      of_recording(Rule::set_quantity,
                   [](Recording& r) {
                     r.overrides = {{index("V_L"), 1.0}};
                   }),
      of_recording(Rule::set_quantity,
                   [](Recording& r) {
                     r.overrides = {{index("K_f"), 0.0}};
                   }),
      of_recording(Rule::set_quantity,
                   [](Recording& r) {
                     r.overrides = {{index("initial.y0"), kNan}};
                   }),
      of_recording(Rule::gap, [](Recording& r) { r.times.edit()[199] += 1000.0; }),
      {Rule::duration,
       [](Job& job) {
         job.options.step = 1e-7;
         for (double& t : job.recordings[0].times.edit()) t *= 1.5;
       }},
      {Rule::same_samples,
       [](Job& job) {
         job.recordings[1] = job.recordings[0];
         job.recordings[1].name = "again";
       }},
      of_recording(Rule::measured, [](Recording& r) { r.measurements.clear(); }),
      of_recording(Rule::fitted_signal,
                   [](Recording& r) {
                     for (Measurement& m : r.measurements) m.fitted = false;
                   }),
      of_recording(Rule::unscored,
                   [](Recording& r) {
                     r.score_initial_samples = false;
                     r.initial_samples = 200;
                   }),
      of_recording(Rule::initial_state,
                   [](Recording& r) {
                     r.initial_state = InitialState::data;
                     r.measurements.resize(1);
                     r.measurements[0].signal = Signal::acceleration;
                   }),
      of_fixed(Rule::tracked_signal,
               [](Job& job) {
                 job.recordings[0].measurements.resize(1);
                 job.recordings[0].measurements[0].signal = Signal::acceleration;
               }),
      of_fixed(Rule::late_filter,
               [](Job& job) {
                 Filter& filter = job.recordings[0].measurements[1].filter;
                 filter.kind = Filter::Kind::moving_average;
                 filter.length = 4;
               }),
      of_fixed(Rule::late_instrument,
               [](Job& job) { job.free[0] = free_parameter("velocity.delay", 0.01); }),
      of_fixed(Rule::late_instrument,
               [](Job& job) {
                 job.recordings[0].overrides = {{index("position.lag"), 0.01}};
               }),
      {Rule::horizon,
       [](Job& job) {
         job.options.criterion = Windows{1.0};
         job.recordings[0].measurements.resize(1);
         job.recordings[0].measurements[0].signal = Signal::acceleration;
       }},
      {Rule::horizon,
       [](Job& job) {
         job.choose_criterion = true;
         job.model.structure.closed_loop = true;
         job.recordings[0].command.meaning = Meaning::reference;
       }},
      of_measurement(Rule::signal, [](Measurement& m) { m.signal = Signal::motor_current; }),
      of_measurement(Rule::second_signal, [](Measurement& m) { m.signal = Signal::position; }),
      of_measurement(Rule::values, [](Measurement& m) { m.values.edit().pop_back(); }),
      of_measurement(Rule::values, [](Measurement& m) { m.values.edit()[3] = kNan; }),
      of_measurement(Rule::flags, [](Measurement& m) { m.excluded = {true}; }),
      of_measurement(Rule::flags, [](Measurement& m) { m.uninformative.assign(201, false); }),
      of_measurement(Rule::filter, [](Measurement& m) { m.hold = 0; }),
      of_measurement(Rule::filter, [](Measurement& m) { m.filter.cutoff = 0.5; }),
      of_measurement(Rule::filter,
                     [](Measurement& m) {
                       m.filter.kind = Filter::Kind::moving_average;
                       m.filter.length = 4;
                       m.filter.zero_phase = true;
                     }),
      of_measurement(Rule::sigma, [](Measurement& m) { m.sigma = 0.0; }),
      of_measurement(Rule::sigma, [](Measurement& m) { m.sigma = kNan; }),
      of_parameter(Rule::sigma,
                   [](FreeParameter& p) {
                     p.prior = Prior{10.0, 0.0};
                   }),
      of_parameter(Rule::quantity, [](FreeParameter& p) { p.quantity = 100'000; }),
      of_parameter(Rule::quantity, [](FreeParameter& p) { p.quantity = index("V_L"); }),
      of_parameter(Rule::recording, [](FreeParameter& p) { p.recording = 2; }),
      {Rule::second_free,
       [](Job& job) {
         job.free[1] = job.free[0];
         job.free[1].recording = 0;
       }},
      of_parameter(Rule::scale, [](FreeParameter& p) { p.lower = 0.0; }),
      of_parameter(Rule::initial, [](FreeParameter& p) { p.initial = 1e6; }),
      of_parameter(Rule::initial, [](FreeParameter& p) { p.upper = kNan; }),
      of_parameter(Rule::bounds, [](FreeParameter& p) { p.lower = p.upper = p.initial; }),
      of_parameter(Rule::bounds, [](FreeParameter& p) { p.upper = 1e6; }),
      of_parameter(Rule::prior_mean,
                   [](FreeParameter& p) {
                     p.prior = Prior{kNan, 1.0};
                   }),
      of_recording(Rule::free_and_set,
                   [](Recording& r) {
                     r.overrides = {{index("M"), 5.0}};
                   }),
  };
}

TEST(Validation, PassesAGoodJob) {
  EXPECT_TRUE(faults(good_job()).empty());
  EXPECT_NO_THROW(validate(good_job()));
}

TEST(Validation, FindsEachRuleThatIsBroken) {
  std::set<Rule> found;
  std::size_t number = 0;
  for (const auto& [rule, make] : broken()) {
    Job job = good_job();
    make(job);
    const std::vector<JobFault> list = faults(job);
    ASSERT_FALSE(list.empty()) << "case " << number;
    EXPECT_EQ(list[0].rule, rule) << "case " << number << ": " << list[0].message;
    EXPECT_EQ(list.size(), 1u) << "case " << number << ": " << list.back().message;
    EXPECT_FALSE(list[0].message.empty());
    found.insert(list[0].rule);
    ++number;
  }
  EXPECT_EQ(found.size(), static_cast<std::size_t>(Rule::free_and_set) + 1);
}

TEST(Validation, SaysWhatAFaultIsAbout) {
  Job job = good_job();
  job.recordings[1].measurements[1].sigma = 0.0;
  job.free[1].initial = -1.0;
  const std::vector<JobFault> list = faults(job);
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].recording, 1u);
  EXPECT_EQ(list[0].measurement, 1u);
  EXPECT_EQ(list[0].parameter, std::nullopt);
  EXPECT_EQ(list[1].recording, std::nullopt);
  EXPECT_EQ(list[1].parameter, 1u);
}

TEST(Validation, KeepsARunFromABrokenJob) {
  Job job = good_job();
  job.recordings[1].measurements[1].sigma = 0.0;
  job.recordings[0].held_out = {true};
  job.free[1].scale = Scale::linear;
  job.free[1].initial = -1.0;
  job.options.starts = 0;
  try {
    run(job);
    ADD_FAILURE() << "it was fitted";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "recording 'fit': of 1 samples it is said whether they are held out, but there "
                 "are 200\n"
                 "recording 'check', velocity: sigma must be above zero: residuals are divided by "
                 "it\n"
                 "free B_a: the initial value -1 N s/m of B_a lies outside its bounds, 0 N s/m "
                 "to 1e+06 N s/m\n"
                 "starts must be at least 1, not 0");
  }
}

}  // namespace
}  // namespace axisfit
