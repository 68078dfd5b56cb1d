// Derivatives through events against central differences of the simulation itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>

#include "tests/sim/experiment.h"

namespace axisfit {
namespace {

/// As in testdata/clean-fit.csv, in which the teeth part and meet again, but from a start in motion
/// and with a delay and instruments that are not trivial.
Experiment up_and_back() {
  Experiment experiment;
  Model<double>& m = experiment.model;
  m = paper_axis();
  m.axis.T_d = 0.00037;
  m.initial = {0.01, 0.02, 2e-6, 1e-3, 0.3, 2.0, 0.1};
  for (const Signal signal : kRecorded) m.instruments[index_of(signal)] = {1.1, 0.02};
  experiment.command = {{0.0, 1.5}, {10.0, 0.0}};
  experiment.times = instants(2500, 1e-3);
  return experiment;
}

TEST(Derivatives, EqualDifferencesWhereTheTeethPartAndMeet) { expect_derivatives(up_and_back()); }

TEST(Derivatives, EqualDifferencesWithFrictionAndEffects) {
  Experiment experiment = up_and_back();
  experiment.model.axis.F_s = 30.0;
  add_effect<CoulombFriction>(experiment.model).F_c = 15.0;
  add_effect<ConstantForce>(experiment.model).F_0 = -8.0;
  add_effect<QuadraticDrag>(experiment.model).c = 20.0;
  expect_derivatives(experiment);
}

TEST(Derivatives, EqualDifferencesInTheRigidVariants) {
  for (const Drive drive : every_drive()) {
    SCOPED_TRACE(static_cast<int>(drive));
    Experiment experiment = up_and_back();
    Model<double>& m = experiment.model;
    m.structure.drive = drive;
    m.structure.transmission = Transmission::rigid;
    m.initial[2] = m.initial[3] = 0.0;
    m.axis.F_s = 30.0;
    m.axis.K_f = 20.0;
    add_effect<CoulombFriction>(m).F_c = 15.0;
    if (capabilities(m.structure).is_direct())
      experiment.command = {{0.0, 0.8, 1.6}, {10.0, 0.0, -7.0}};
    if (drive == Drive::motor_voltage) experiment.command.values = {30.0, 0.0, -20.0};
    expect_derivatives(experiment);
  }
}

TEST(Derivatives, EqualDifferencesInACoupledRun) {
  for (const Observer& observer : {Observer::of_velocity(30.0, true), Observer::of_position(300.0),
                                   Observer::of_velocity(3000.0, false)}) {
    SCOPED_TRACE(testing::Message()
                 << observer.velocity << " " << observer.position << " " << observer.acceleration);
    Experiment experiment = up_and_back();
    experiment.command = {{0.0, 0.3}, {10.0, 0.0}};
    experiment.times = instants(600, 1e-3);
    // Held to an axis somewhat different.
    Model<double> other = experiment.model;
    other.axis.B_a *= 1.2;
    other.axis.k_g *= 0.8;
    const Traces<double> measured = experiment.traces(other);
    experiment.velocity = measured.signals[0];
    experiment.position = measured.signals[2];
    experiment.observer = observer;
    expect_derivatives(experiment);
  }
}

TEST(Derivatives, AreWrongWithoutThoseOfTheEvents) {
  const Experiment experiment = up_and_back();
  std::vector<QuantityEntry> entries;
  for (const char* name : {"V_L", "B_a", "b_g", "k_g", "T_p"})
    entries.push_back(quantity_list()[quantity_index(name)]);
  const IntegratorOptions without{.event_derivatives = false};
  double largest[2] = {0.0, 0.0};
  compare(experiment, entries,
          {by_jets(experiment, entries), by_jets(experiment, entries, without)},
          [&](std::size_t candidate, const Comparison& c) {
            largest[candidate] = std::max(largest[candidate], c.error);
          });
  std::cout << "largest error " << largest[0] << ", without event derivatives " << largest[1]
            << "\n";
  EXPECT_LT(largest[0], 1e-4);
  EXPECT_GT(largest[1], 1e-2);
}

}  // namespace
}  // namespace axisfit
