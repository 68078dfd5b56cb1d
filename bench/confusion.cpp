// confusion: how often closing the loop finds the effect that a recording holds.
//
// Simulates pairs of recordings (one to fit, one to validate) of axes with an effect that is not
// declared, closes the loop on each, and counts what was accepted. Base parameters, motions, the
// effect's shape and sign are drawn anew for every case, from the seed and the number of the case
// alone. The strength is searched: such that the best fit without the effect has the wanted reduced
// chi-square.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>
#include <numbers>
#include <set>

#include "base/parallel.h"
#include "base/random.h"
#include "bench/simulated.h"
#include "fit/data/standstill.h"
#include "fit/search/select_effects.h"
#include "fit/solve/residual.h"
#include "fit/solve/solve.h"
#include "io/config/axis_file.h"
#include "report/text/words.h"

namespace {

using namespace axisfit;

class Draw {
 public:
  Draw(std::uint64_t seed, std::uint64_t number) {
    std::seed_seq seeds{seed, number};
    generator_.seed(seeds);
  }
  double uniform(double a, double b) { return a + (b - a) * axisfit::uniform(generator_); }
  double factor(double k) { return std::pow(k, uniform(-1.0, 1.0)); }
  double sign() { return uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0; }

 private:
  std::mt19937_64 generator_;
};

/// An effect as it is put into a simulated axis: what is proportional to its strength, per unit of
/// it, and its shape.
struct Secret {
  std::string name;  ///< as in the catalogue
  std::vector<std::pair<std::string, double>> strengths, shapes;
  double unit = 1.0;  ///< a first guess of a noticeable strength
  double most = INFINITY;
};

bool is_curve(std::string_view name) { return name.find("_over_") != name.npos; }

/// Whether an axis of the paper can have an effect, without another one that it extends.
bool stands_alone(const EffectInfo& effect) {
  return std::ranges::any_of(effect.search({}), [](const SearchEntry& entry) {
    return entry.extends.empty() && is_used(entry.used_by, Structure{});
  });
}

/// Whether an effect is nothing without the dry friction that it changes.
bool changes_dry_friction(const std::string& name) {
  const auto effect = effect_named(name);
  return effect &&
         std::ranges::any_of(kEffectTable[*effect].search({}), &SearchEntry::changes_dry_friction);
}

/// All effects but the curves and the gravity of a pendulum, which this axis is not (over a few
/// hundredths of a radian it is a constant force and a spring); dead time and instruments; and at
/// last a curve, which stands for an effect outside of the catalogue.
const std::vector<std::string>& secret_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const ActsOn place : kPlacesToAct)
      for (const EffectInfo& effect : kEffectTable)
        if (effect.acts_on == place && !is_curve(effect.name) && stands_alone(effect) &&
            effect.name != "pendulum_gravity")
          list.emplace_back(effect.name);
    for (const char* other : {"dead_time", "acceleration.bias", "acceleration.gain",
                              "acceleration.lag", "velocity.gain", "velocity.lag", "velocity.delay",
                              "velocity.drift", "tachometer.gain", "force_over_position"})
      list.emplace_back(other);
    return list;
  }();
  return names;
}

/// An effect of which nothing else is known: at about its typical strength, at most three times it,
/// and its typical shape.
Secret typical_secret(const EffectInfo& effect, Draw& draw) {
  Secret secret{std::string(effect.name), {}, {}, 1.0, 3.0};
  for (const QuantityEntry& entry : quantity_list()) {
    if (entry.group != effect.name) continue;
    const double value = entry.quantity.typical;
    const std::string symbol(entry.quantity.symbol);
    if (entry.quantity.shape)
      secret.shapes.emplace_back(symbol, value * draw.factor(2));
    else
      secret.strengths.emplace_back(symbol,
                                    entry.quantity.lower < 0.0 ? draw.sign() * value : value);
  }
  return secret;
}

/// `low` and `high`: the stroke that both motions pass, m.
Secret draw_secret(const std::string& name, double low, double high, Draw& draw) {
  const double s = draw.sign(), phase = draw.uniform(0.0, 2.0 * std::numbers::pi);
  const double a = std::sin(phase), b = std::cos(phase);
  if (name == "coulomb_friction") return {name, {{"F_c", 1}}, {}, 5};
  if (name == "directional_friction") return {name, {{"dB_a", s}}, {}, 10};
  if (name == "stribeck_friction")
    return {name, {{"F_st", s}}, {{"v_st", draw.uniform(0.01, 0.1)}}, 10};
  if (name == "position_friction") return {name, {{"G_c", 1}}, {}, 10};
  if (name == "load_friction") return {name, {{"mu", 1}}, {}, 0.02, 0.5};
  if (name == "dahl_friction") return {name, {{"F_d", 1}}, {{"l_d", 1e-3 * draw.factor(3)}}, 5};
  if (name == "constant_force") return {name, {{"F_0", s}}, {}, 5};
  if (name == "quadratic_drag") return {name, {{"c", 1}}, {}, 20};
  if (name == "stroke_spring") return {name, {{"k_s", 1}}, {}, 10};
  if (name == "end_stops")
    return {name, {{"k_h", 1}}, {{"y_h", high - draw.uniform(0.05, 0.2) * (high - low)}}, 1e4};
  if (name == "periodic_force")
    return {name, {{"F_s1", a}, {"F_c1", b}}, {{"period", 0.06 * draw.factor(3)}}, 5};
  if (name == "added_mass") return {name, {{"dM", s}}, {}, 5, 80};
  if (name == "payload_change")
    return {name, {{"dM", s}}, {{"t_c", draw.uniform(0.6, 2.4)}}, 5, 80};
  if (name == "elastic_mode")
    return {name, {{"m_e", 1}}, {{"f_e", draw.uniform(10, 60)}, {"zeta_e", 0.03}}, 3, 60};
  if (name == "cogging_torque")
    return {name, {{"T_s", a}, {"T_c", b}}, {{"order", std::floor(draw.uniform(1, 5))}}, 0.03};
  if (name == "torque_ripple")
    return {name, {{"r_s", a}, {"r_c", b}}, {{"order", std::floor(draw.uniform(1, 5))}}, 0.01, 0.5};
  if (name == "torque_droop") return {name, {{"c_i", 1}}, {}, 0.005, 0.08};
  if (name == "torque_fade") return {name, {{"c_t", 1}}, {}, 0.01, 0.5};
  if (name == "drive_lag") return {name, {{"T_l", 1}}, {}, 0.002, 0.05};
  if (name == "command_offset") return {name, {{"U_0", s}}, {}, 0.02};
  if (name == "dead_time") return {name, {{"T_d", 1}}, {}, 0.001, 0.05};
  if (name == "force_over_position") {  // outside the catalogue: a bump somewhere on the stroke
    const int k = static_cast<int>(draw.uniform(5, 12));
    return {name,
            {{fmt::format("c{}", k), s}, {fmt::format("c{}", k + 1), 0.7 * s}},
            {{"from", low}, {"to", high}},
            20};
  }
  if (const auto effect = effect_named(name)) return typical_secret(kEffectTable[*effect], draw);
  // Instruments: "signal.part".
  if (name.ends_with(".bias")) return {name, {{name, s}}, {}, 0.02};
  if (name.ends_with(".gain")) return {name, {{name, s}}, {}, 0.01, 0.5};
  if (name.ends_with(".drift")) return {name, {{name, s}}, {}, 0.001, 0.05};
  if (name.ends_with(".lag")) return {name, {{name, 1}}, {}, 0.001, 0.05};
  return {name, {{name, s}}, {}, 0.001, 0.05};
}

std::size_t quantity(const Secret& secret, const std::string& symbol) {
  const QuantityEntry* entry = find_quantity(symbol, kSourceVocabulary);
  return entry != nullptr ? entry->index : quantity_index(secret.name + "." + symbol);
}

void put(const Secret& secret, double strength, Model<double>& model) {
  const auto member = members(model);
  if (const auto effect = effect_named(secret.name)) {
    model.structure.effects.set(*effect);
    for (const QuantityEntry& entry : quantity_list())
      if (const double value = entry.quantity.default_value; entry.group == secret.name)
        *member[entry.index] = std::isnan(value) ? 0.0 : value;
  }
  for (const auto& [symbol, value] : secret.shapes) *member[quantity(secret, symbol)] = value;
  for (const auto& [symbol, value] : secret.strengths)
    *member[quantity(secret, symbol)] += strength * value;
}

Motion draw_motion(int kind, Draw& draw) {
  const double u = draw.uniform(5.0, 10.0);
  // Commands switch when the controller samples, and so does the recorded column.
  const auto held = [&](double a, double b) {
    return 0.005 * std::round(draw.uniform(a, b) / 0.005);
  };
  switch (kind) {
    case 0:  // out and back to rest
      return LevelsMotion{{u, u, 0.0, -u, -u, 0.0}, 0.5};
    case 1: {
      LevelsMotion levels{{}, held(0.4, 0.6)};
      for (int i = 0; i < 7; ++i) levels.levels.push_back(draw.sign() * draw.uniform(1.0, u));
      return levels;
    }
    case 2:
      return SineMotion{u, 0.3, draw.uniform(2.0, 5.0)};
    default:
      return PrbsMotion{u, held(0.1, 0.3), 0.0, 7};
  }
}

struct Case {
  std::string kind;             ///< "clean", an effect, or "pair"
  std::vector<std::string> in;  ///< effects that are in it
  double target = 1.0;          ///< reduced chi-square without the effects
  int repeat = 0;

  std::string label() const { return in.empty() ? kind : fmt::format("{}", fmt::join(in, "+")); }
  /// By what the case is, so that a part of the grid has the same cases as the whole. FNV-1a.
  std::uint64_t number() const {
    std::uint64_t hash = 14695981039346656037u;
    for (const char c : fmt::format("{} {} {}", label(), target, repeat))
      hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
    return hash >> 32;
  }
};

struct CaseOutcome {
  double reached = 0.0;
  double last = 0.0;  ///< reduced chi-square of the result, all recordings
  std::set<std::string> accepted, undecided;
  bool explained = false;
  std::string story;  ///< every trial and its reason
};

Job job_of(const Rig& rig, const Model<double>& declared, const std::vector<Motion>& motions,
           std::uint64_t seed, Draw& draw) {
  Job job;
  job.model = declared;
  for (std::size_t r = 0; r < motions.size(); ++r) {
    RecordingOptions options;
    options.duration = 3.0;
    options.seed = seed * 2 + r;
    options.signals = {Signal::velocity, Signal::acceleration, Signal::tachometer};
    Recording recording = simulated(rig, motions[r], options);
    recording.name = r == 0 ? "fit" : "validate";
    recording.role = r == 0 ? Role::fit : Role::validate;
    exclude_acceleration_at_standstill(recording);
    job.recordings.push_back(std::move(recording));
  }
  std::vector<const char*> names{"V_L", "B_a", "b_g", "k_g", "T_p"};
  if (declared.structure.effects[*effect_named("coulomb_friction")])
    names.push_back("coulomb_friction.F_c");
  for (const char* name : names)
    job.free.push_back(free_parameter(job.model, name, draw.factor(2.0)));
  return job;
}

/// What a fit from the true values would reach, to first order; not a number where it fails.
double refitted_chi_square(const Job& job) {
  const ParameterSpace space(job);
  Model<double> model = job.model;
  const auto member = members(model);
  std::vector<double> truth;
  for (const FreeParameter& p : job.free) truth.push_back(*member[p.quantity]);
  const Linearization at = linearize(job, space, space.internal(truth), 0.0);
  if (!at.finite) return NAN;
  const Eigen::VectorXd standstill =
      at.residuals -
      at.jacobian * at.jacobian.completeOrthogonalDecomposition().solve(at.residuals);
  return standstill.squaredNorm() / static_cast<double>(standstill.size());
}

CaseOutcome run(const Case& one, const Rig& paper, std::uint64_t seed) {
  const std::uint64_t number = one.number();
  Draw draw(seed, number);
  Rig rig = paper;
  Axis<double>& axis = rig.model.axis;
  for (double* p : {&axis.V_L, &axis.B_a, &axis.b_g, &axis.k_g, &axis.M, &axis.H})
    *p *= draw.factor(1.4);
  axis.T_p *= draw.factor(1.5);
  if (draw.uniform(0.0, 1.0) < 0.5) axis.F_s = 0.0;
  if (std::ranges::any_of(one.in, changes_dry_friction))
    put({"coulomb_friction", {{"F_c", 1}}, {}, 8}, 8.0, rig.model);
  const int kind = static_cast<int>(draw.uniform(0, 4));
  std::vector<Motion> motions{draw_motion(kind, draw), draw_motion((kind + 1) % 4, draw)};
  const Model<double> declared = rig.model;
  std::vector<Secret> secrets;

  CaseOutcome outcome;
  const auto job_with = [&](const std::vector<double>& with) {
    Rig secretly = rig;
    for (std::size_t i = 0; i < with.size(); ++i) put(secrets[i], with[i], secretly.model);
    Draw again(seed + 1, number);
    return job_of(secretly, declared, motions, number, again);
  };
  // The stroke of a motion without the effects, and what both motions pass of it.
  const auto stroke = [&](std::size_t motion) {
    Job without = job_with({});
    without.free.clear();
    const auto samples =
        simulate_recording(without, ParameterSpace(without), motion, nullptr, {}).samples;
    const auto [least, most] = std::ranges::minmax(samples, {}, &Sample::position);
    return std::pair{least.position, most.position};
  };
  double low = 0.0, high = 0.0;
  const bool on_stroke = std::ranges::find(one.in, "force_over_position") != one.in.end();
  Draw redraw(seed + 2, number);
  for (int k = 0; on_stroke && k < 20; ++k) {
    const auto [a, b] = stroke(0);
    const auto [c, d] = stroke(1);
    low = std::max(a, c);
    high = std::min(b, d);
    // A bump that the motion to validate does not pass cannot be accepted.
    if (high - low > 0.5 * (b - a)) break;
    motions[1] = draw_motion(k % 4, redraw);
  }
  for (const std::string& name : one.in) secrets.push_back(draw_secret(name, low, high, draw));
  // The excess of chi-square grows with the square of the strength.
  std::vector<double> strengths(secrets.size());
  const auto factor_for = [&](double chi_square) {
    const double excess = std::isfinite(chi_square) ? std::max(chi_square - 1.0, 0.02) : 1e4;
    return std::clamp(std::sqrt((one.target - 1.0) / excess), 0.1, 5.0);
  };
  for (std::size_t i = 0; i < secrets.size(); ++i) {
    strengths[i] = secrets[i].unit;
    for (int k = 0; k < 8; ++k) {
      std::vector<double> alone(secrets.size(), 0.0);
      alone[i] = strengths[i];
      const double factor = factor_for(refitted_chi_square(job_with(alone)));
      strengths[i] = std::min(secrets[i].most, strengths[i] * factor);
      if (std::abs(factor - 1.0) < 0.1) break;
    }
  }
  Job job = job_with(strengths);
  FitResult fit = estimate(job);
  // What a fit reaches by more than a small step is known when it has been made.
  for (int k = 0; k < 4 && secrets.size() == 1; ++k) {
    const double factor = factor_for(fit.reduced_chi_square);
    if (std::abs(factor - 1.0) < 0.2 || strengths[0] * factor > secrets[0].most) break;
    strengths[0] *= factor;
    job = job_with(strengths);
    fit = estimate(job);
  }
  outcome.reached = fit.reduced_chi_square;
  const EffectSelection selection = select_effects(job, fit);
  for (const Outcome& trial : selection.effects) {
    const Hypothesis& c = trial.hypothesis;
    const bool is_more_of_it = !c.extends.empty() && c.name.starts_with(c.extends + ".");
    if (trial.decision() == Decision::accepted)
      outcome.accepted.insert(is_more_of_it ? c.extends : c.name);
    if (trial.decision() == Decision::undecided) outcome.undecided.insert(trial.hypothesis.name);
    outcome.story += fmt::format("    round {} {}: {} (score {:.4g}, {:.3g} %)\n", trial.round,
                                 trial.hypothesis.name, reason_text(selection.result.job, trial),
                                 trial.score, trial.improvement.validate_percent);
  }
  outcome.explained = selection.explained;
  outcome.last = selection.models.back().fit.reduced_chi_square;
  return outcome;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"How often closing the loop finds the effect that a simulated recording holds."};
  std::string axis_path;
  std::vector<double> targets{1.5, 3.0, 10.0};
  std::vector<std::string> effects = secret_names();
  int clean = 50, pairs = 20, threads = 0, repeats = 1;
  std::uint64_t seed = 1;
  bool verbose = false;
  app.add_option("AXIS.yaml", axis_path, "axis around which parameters are drawn")->required();
  app.add_option("--effects", effects, "effects to try alone")->delimiter(',');
  app.add_option("--targets", targets, "reduced chi-squares without the effect")->delimiter(',');
  app.add_option("--repeats", repeats, "cases per effect and target");
  app.add_option("--clean", clean, "cases without an effect");
  app.add_option("--pairs", pairs, "cases with two effects");
  app.add_flag("--verbose", verbose, "say of every effect that was tried what became of it");
  app.add_option("--seed", seed, "of everything drawn");
  app.add_option("--threads", threads, "default: all cores");
  CLI11_PARSE(app, argc, argv);

  Diagnostics diagnostics;
  const std::optional<Rig> paper = read_axis_file(axis_path, diagnostics);
  diagnostics.throw_if_any();
  std::vector<Case> cases;
  for (int i = 0; i < clean; ++i) cases.push_back({"clean", {}, 1.0, i});
  for (const std::string& effect : effects)
    for (const double target : targets)
      for (int i = 0; i < repeats; ++i) cases.push_back({effect, {effect}, target, i});
  Draw draw(seed, 999999);
  for (int i = 0; i < pairs; ++i) {
    const auto any = [&] {
      return secret_names()[static_cast<std::size_t>(
          draw.uniform(0, static_cast<double>(secret_names().size())))];
    };
    std::string a = any(), b = any();
    while (b == a) b = any();
    cases.push_back({"pair", {a, b}, 3.0, i});
  }

  std::vector<CaseOutcome> outcomes(cases.size());
  std::mutex mutex;
  const ThreadPool pool(threads);
  parallel_for(cases.size(), [&](std::size_t i) {
    outcomes[i] = run(cases[i], *paper, seed);
    const std::lock_guard lock(mutex);
    fmt::print("{:24} target {:4} chi2 {:8.3f} -> {:7.3f} accepted [{}] undecided [{}]{}\n",
               cases[i].label(), cases[i].target, outcomes[i].reached, outcomes[i].last,
               fmt::join(outcomes[i].accepted, " "), fmt::join(outcomes[i].undecided, " "),
               outcomes[i].explained ? "" : " unexplained");
    if (verbose) fmt::print("{}", outcomes[i].story);
    std::fflush(stdout);
  });

  // The table: by kind and target, how often right, undecided with the right one, wrong, nothing.
  struct Count {
    int cases = 0, unseen = 0, right = 0, undecided = 0, missed = 0, wrong = 0;
    std::map<std::string, int> wrongly;
  };
  std::map<std::pair<std::string, double>, Count> table;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    Count& count = table[{cases[i].kind, cases[i].target}];
    const CaseOutcome& o = outcomes[i];
    const std::set<std::string> truth(cases[i].in.begin(), cases[i].in.end());
    ++count.cases;
    // An effect outside the catalogue is rightly drawn as a curve, over whatever variable.
    const bool outside = std::ranges::any_of(truth, is_curve);
    std::set<std::string> wrong, accepted;
    for (const std::string& name : o.accepted)
      accepted.insert(outside && is_curve(name) ? "force_over_position" : name);
    std::ranges::set_difference(accepted, truth, std::inserter(wrong, wrong.end()));
    for (const std::string& name : wrong) ++count.wrongly[name];
    if (!wrong.empty())
      ++count.wrong;
    else if (accepted == truth)
      ++count.right;
    else if (!truth.empty() && o.reached < 1.0 + 0.2 * (cases[i].target - 1.0))
      ++count.unseen;  // whatever its strength, the free parameters make up for it
    else if (!o.undecided.empty())
      ++count.undecided;
    else
      ++count.missed;
  }
  fmt::print(
      "\n| effect | chi-square | cases | unseen | right | undecided | missed | wrong | wrongly "
      "accepted |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [key, c] : table) {
    std::vector<std::string> names;
    for (const auto& [name, n] : c.wrongly) names.push_back(fmt::format("{} {}", n, name));
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", key.first, key.second, c.cases,
               c.unseen, c.right, c.undecided, c.missed, c.wrong, fmt::join(names, ", "));
  }

  // The aims, over what could be seen and told apart.
  constexpr double kStrong = 3.0, kLeastRight = 95.0, kMostWrong = 2.0;  // percent
  int decided = 0, right = 0, without = 0, wrong = 0;
  for (const auto& [key, c] : table) {
    if (key.first == "clean") {
      without += c.cases;
      wrong += c.wrong;
    } else if (key.first != "pair" && key.second >= kStrong) {
      decided += c.cases - c.unseen - c.undecided;
      right += c.right;
    }
  }
  const auto percent = [](int part, int of) { return of > 0 ? 100.0 * part / of : 0.0; };
  fmt::print(
      "\nOf single effects at chi-square {} and above that are seen and decided, right: {} of {} "
      "({:.1f} %).\nOf recordings without an effect, one accepted: {} of {} ({:.1f} %).\n",
      kStrong, right, decided, percent(right, decided), wrong, without, percent(wrong, without));
  const bool met = (decided == 0 || percent(right, decided) >= kLeastRight) &&
                   percent(wrong, without) <= kMostWrong;
  return met ? 0 : 1;
}
