// The first look at recordings: one mass with friction, by linear regression, without a model and
// without a simulation.
//
// The balance of forces of all recordings together,
//
//   M y'' + B y' + F_c sign(y') + F_0 + G_s sin(y) + G_c cos(y) = u(t - d),
//
// is taken in its weak form: times a window w that vanishes smoothly at both ends, and integrated,
// so that the derivatives are those of the window, M y'' becoming the integral of w'' y. Noise of
// the readings then enters by integrals alone, and what it adds to the squares of the regressors
// is known and subtracted (total least squares with known noise). Of several lengths of windows
// the one is taken that tells the most. The time d by which the motion follows the input is where
// least remains.
//
// Where that leaves much, dry friction may build up over a travel instead of at once: in the place
// of sign(y') stands the state z of P. R. Dahl's law (dahl_friction.h), which follows from the
// readings alone, with the travel at which least remains.
//
// Literature: D. A. Messenger and D. M. Bortz, Journal of Computational Physics 443 (2021), for the
// weak form; W. A. Fuller, Measurement Error Models (1987), for the subtraction.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "sim/vocabulary.h"

namespace axisfit {

/// A recording, one value per sample. Of position and velocity one may be empty.
struct DrivenMotion {
  std::span<const double> times;     ///< s, increasing
  std::span<const double> position;  ///< m, or rad
  std::span<const double> velocity;  ///< m/s, or rad/s
  std::span<const double> input;     ///< what drives it, in any unit; linear from sample to sample
};

struct FirstLookOptions {
  bool with_gravity = false;    ///< on a joint; needs positions
  double least_delay = -0.02;   ///< s, from which delays are tried, within half a recording ...
  double longest_delay = 0.25;  ///< s, ... to which
  /// m, or rad: over which dry friction builds up. Zero: at once.
  double presliding = 0.0;
  double window = 0.0;  ///< s, that of windows of one length only; zero: the best
  /// The length of the windows is that which explains the most, not that which tells the most: for
  /// a delay that may be anything, since short windows tell a lot of what is not there.
  bool by_evidence = false;
};

/// Forces are in units of the input.
struct FirstLook {
  /// An estimate with its standard error, which allows for the autocorrelation of the balance.
  struct Term {
    double value = 0.0, error = std::numeric_limits<double>::infinity();

    /// Standard errors from zero.
    double distance() const { return error > 0.0 ? value / error : 0.0; }
  };

  Term mass, viscous, coulomb, constant;
  Term gravity_sine, gravity_cosine;  ///< zero without gravity
  Term delay;                         ///< s, by which the motion follows the input
  Term dissipation;  ///< unit of the input times m/s: the mean power that friction takes
  /// The mass that would take all of the input: the size of one that the balance does not show.
  double largest_mass = 0.0;
  /// 1 or -1 where the motion goes that way only. Nothing then tells a constant force from dry
  /// friction, which it is taken for; otherwise zero.
  double only_way = 0.0;
  double presliding = 0.0;   ///< m, or rad, over which dry friction builds up; zero: at once
  double unexplained = 1.0;  ///< part of the input's root mean square that remains
  double window = 0.0;       ///< s, length of the windows

  /// Which way the input acts. A passive load takes work in, whatever its mass: friction
  /// dissipates. Where it shows no friction, the mass is positive. In a motion one way a weight may
  /// do what friction would be turned for.
  enum class Direction {
    along,   ///< as recorded
    turned,  ///< beyond doubt against what was recorded
    open,    ///< neither friction nor mass tell, or they contradict each other
  };
  Direction direction = Direction::open;

  /// Correlation of the input with what one mass explains of it.
  double explained() const { return std::sqrt(std::max(0.0, 1.0 - unexplained * unexplained)); }
  /// Whether the mass takes a part of the input that imperfections of the model do not make.
  bool is_mass_noticeable() const { return std::abs(mass.value) > 0.02 * largest_mass; }
  /// Whether friction or a mass shows at all, either way.
  bool shows_anything() const {
    return std::abs(dissipation.distance()) > kSure ||
           (std::abs(mass.distance()) > kSure && is_mass_noticeable());
  }
  bool shows_mass() const { return mass.distance() > kSure && is_mass_noticeable(); }
  bool shows_delay(double interval) const {
    return std::abs(delay.value) > 0.5 * interval && std::abs(delay.distance()) > kSure;
  }
  /// Standard errors that leave no doubt.
  static constexpr double kSure = 4.0;
};

/// None where there are too few samples, where the input never changes, or where nothing moves.
std::optional<FirstLook> first_look(std::span<const DrivenMotion> motions,
                                    const FirstLookOptions& options = {});

/// The same; of a joint with gravity, and with friction that builds up over a travel, where that
/// leaves clearly less of the input.
std::optional<FirstLook> first_look(std::span<const DrivenMotion> motions, Joint joint);

}  // namespace axisfit
