// The numbers that decide in a search for effects: each has a name, a reason, and this one place.
#pragma once

#include <array>
#include <cstddef>

#include "fit/solve/run_context.h"

namespace axisfit {

/// The figures of docs/effect-selection.md were measured with these values.
struct SearchOptions {
  int max_effects = 6;  ///< that a model may be given: more would be a description of the data
  /// Reduced chi-square below which next to nothing may be missing: a quick fit, or noise of the
  /// readings that drives a simulation that tracks, may make what is left.
  double near_noise = 2.0;
  double near_data = 5.0;  ///< the same, where the free run tells by itself what is missing

  /// The score test, which looks at all hypotheses without a refit.
  struct Scoring {
    /// Part of a hypothesis' effect on the residuals that the free parameters cannot imitate: less
    /// is rounding.
    double least_own_part = 1e-4;
    /// A linear step is trusted no further: e-folds of a logarithmic parameter (a factor of two),
    /// and part of the range of a linear one.
    double largest_log_step = 0.7, largest_linear_step = 0.1;
    std::size_t refined = 8;     ///< hypotheses whose shapes go on from the settings tried
    int refinements = 2;         ///< steps that they take: the third changes no order
    double beyond_tried = 0.05;  ///< of a shape: a period is not on a grid
    /// Other settings of a transmission, and other probes, take simulations of their own. They are
    /// tried where the first gain this part of what the best hypothesis does.
    double worth_other_probes = 0.1;
    std::size_t first_settings = 9;  ///< fewer settings of a transmission are tried all at once
    std::size_t periods = 3;         ///< of a force along the stroke, from each recording
    std::size_t resonances = 3;      ///< from each series
    std::size_t pulses = 2;          ///< of a force over time, from each recording
    double coarse_step =
        4.0;  ///< of the integrator: smooth effects are 1e-4 off, and four times as quick
    int tracking_iterations = 15;      ///< of the fit that a score starts from
    double tracking_tolerance = 1e-6;  ///< of that
    /// Parts of the highest observer gain that are tried for what is large, the highest first, and
    /// the mean square above which something is: ten times the noise.
    std::array<double, 3> close_gains{1.0, 1.0 / 3.0, 1.0 / 10.0};
    double large_mean_square = 100.0;
    std::size_t suspects = 5;           ///< that a fit without a search names
    double cause_fraction = 1.0 / 3.0;  ///< of the residual that the likely cause explains
    double least_fraction = 0.02;       ///< of the sum of squares, that a suspect would explain
  } scoring;

  /// Which of the scored hypotheses are worth a refit.
  struct Shortlist {
    int length = 6;             ///< about as many, at each observer gain
    double least_gain = 6.0;    ///< of a sum of squares of unit variance: below is chance
    std::size_t first = 3;      ///< that are taken whatever the best gains
    double worth = 0.5;         ///< part of the best gain that is taken beyond the first
    double worth_plain = 0.25;  ///< the same of a law of one number beside a richer one
    double nearly_best = 0.9;   ///< part of the best gain that is taken beyond the length
    /// Part of what is missing that one explains, to first order, at the first gain: then no other
    /// is scored, unless nothing passes.
    double most = 0.6;
    double same_shape = 0.05;  ///< relative difference of shapes whose refits end in one place
  } shortlist;

  /// A refit in a search, content with less than a final one.
  struct Refit {
    int iterations = 25;
    int many_iterations = 100;  ///< of another transmission, whose settings are far apart
  } refit;

  /// The acceptance test.
  struct Acceptance {
    double chance = 1e-3;  ///< how probable a lower validation error may be by chance
    /// The same while effects are collected that mask each other; backward elimination is strict.
    double provisional_chance = 0.05;
    double strength_chance = 3e-4;  ///< the same of a strength that is not zero
    double least_percent = 0.5;     ///< fall of the validation error that matters to anybody
    /// Standard deviations of that fall to expect, beyond which an effect that is there passes in
    /// nine of ten such recordings. Below, the recordings cannot judge.
    double power = 4.4;
    double alias = 1e-10;  ///< part of an effect that nothing imitates: below is rounding
    /// The missing force of a recording that validates is raised that is more than so many times
    /// what it was, and by so many per cent of the drive's.
    double force_times = 1.5, force_percent = 2.0;
    double times_tried = 3.0;  ///< of a shape, beyond which the effect is a simpler one
    double odds = 100.0;       ///< of two models, that make one clearly worse (by BIC)
  } acceptance;

  /// One round: which hypothesis explains the most.
  struct Round {
    /// Reduced chi-square below which the free run is scored, too: farther away it is elsewhere.
    double close_chi_square = 25.0;
    /// Of every signal, below which it is scored alone; of all together, no curve is looked for.
    double exact_mean_square = 1.1;
    /// A refit is hopeless that promises less than this part of what the test asks, unless its
    /// score is many times that: then the refit may find more.
    double promise = 0.4, much = 10.0;
    /// Parts of the best gain: what gains as much is refitted with the best, and what gains less if
    /// that fails, but no less than this.
    double rival_part = 0.6, least_part = 0.4;
    /// Times the gain of the best effect alone, of two that are tried at once before any alone.
    double pair_times = 1.25;
    std::ptrdiff_t at_once = 2;  ///< that are refitted, or asked of other recordings, side by side
    std::size_t most_in_noise = 6;  ///< refits where the fitted recordings hold nothing but noise
    std::size_t blocks = 10;        ///< of a recording, every second of which is held out
  } round;

  /// Two effects that hide each other.
  struct Pairs {
    std::size_t refitted = 2;  ///< of each kind (pairs.h)
  } pairs;

  /// Whether other recordings, fitted by themselves, tell the same.
  struct Replication {
    double far = 4.0;              ///< standard errors from zero that leave no doubt
    double errors = 3.0;           ///< standard errors of a difference that count as alike
    double part = 0.1;             ///< relative difference likewise: no model is better than that
    double part_of_period = 0.02;  ///< of a period: with another one it is another ripple
    double other_errors = 5.0, other_part = 0.1;  ///< beyond both a period is another one
  } replication;

  /// Rivals of what was accepted.
  struct Rivals {
    std::size_t constants = 4;  ///< of a corrected constant, others that do the same
    double imitated = 0.1;      ///< part of a correction that these may leave
    std::size_t refitted = 8;   ///< of one accepted hypothesis
    /// A rival is out of reach that leaves more, to first order, than so many clear differences and
    /// than this part of what it would replace.
    double far = 10.0, left = 0.3;
  } rivals;

  /// What a search that ends far from the noise may name, per cent of the error beyond the noise.
  struct FarFromNoise {
    double of_effect = 25.0;  ///< less may imitate what is missing
    double of_model = 50.0;   ///< of all effects together: half is what a model must do to be one
    /// The same where the roles of the recordings were exchanged: a second try finds more by
    /// chance.
    double of_model_exchanged = 70.0;
    /// The same of effects that were found together, where no other way to them is tried.
    double of_complete_model = 90.0;
    /// Along the motion, of an effect with a period: what it could imitate does not repeat as
    /// often, so that it is named whatever part it explains.
    double periods = 30.0;
  } far_from_noise;

  /// What is tried of another transmission.
  struct Transmission {
    /// Hz, of motor and arm against each other: slower and they would not move together, faster and
    /// it would not show.
    std::array<double, 3> frequencies{15.0, 40.0, 120.0};
    double damping_ratio = 0.1;                        ///< of that motion
    std::array<double, 3> motor_parts{0.1, 0.5, 0.9};  ///< of the moved mass, where it is one
    double least_arm_part = 0.01;                      ///< that is left of it for the arm
    /// Parts of the stroke: from a gap that is hardly seen to one of a few thousandths.
    std::array<double, 3> gaps{1e-4, 5e-4, 3e-3};
  } transmission;

  /// Periods of a force along the stroke, as peaks of a spectrum over it.
  struct Periods {
    double samples_per_period = 4.0;  ///< at the highest speed, at least
    double most_products = 2e8;       ///< samples times lines of a spectrum, which bounds the time
    double cycle_step = 0.25;         ///< cycles per stroke, from line to line: peaks are one wide
    std::size_t first_line = 4;       ///< of one cycle: longer forces are no ripple
    std::size_t sizes = 24;           ///< of a response are computed, which change slowly
    std::size_t exact = 4;            ///< times as many peaks as are wanted are computed exactly
  } periods;

  /// Pulses of a force, as sums over intervals of time.
  struct Pulses {
    std::size_t fewest_samples = 8;       ///< of one: a shorter one is an outlier
    std::size_t fewest_in_recording = 4;  ///< times its length: what lasts longer is no pulse
    double next = 1.25;  ///< from one length that is tried to the next: edges within a tenth
  };

  /// A sum of named terms in the place of a curve.
  struct ClosedForms {
    double chance = 1e-3;        ///< that the curve differs from its form no more than by noise
    std::size_t most_terms = 3;  ///< more say no less than the curve
    double alias = 1e-6;         ///< part of a term that the others cannot make: below is rounding
  } closed_forms;

  double curve_coefficients = 14.0;  ///< that a curve in the place of named effects has, at least
};

/// What all parts of a search are given.
struct SearchContext {
  SearchOptions options{};
  RunContext run{};
};

}  // namespace axisfit
