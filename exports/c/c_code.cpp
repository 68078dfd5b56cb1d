// The axis as source in C: templates that are filled with what its model has.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <complex>
#include <kainjow/mustache.hpp>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "base/embedded.h"
#include "base/linear_algebra.h"
#include "base/plain_text.h"
#include "exports/targets.h"
#include "sim/affine.h"
#include "sim/equations.h"

// The templates.
AXISFIT_EMBEDDED(axis_h)
AXISFIT_EMBEDDED(axis_c)
AXISFIT_EMBEDDED(mex_c)
AXISFIT_EMBEDDED(sfun_c)

namespace axisfit {
namespace {

using kainjow::mustache::data;

/// With a point, as a number that is not whole has in C.
std::string real(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

/// A text from elsewhere inside a comment: it must not end it, nor begin one.
std::string in_comment(std::string_view text) {
  std::string line = sanitized(text);
  for (const std::string_view mark : {"*/", "/*"})
    for (std::size_t at = 0; (at = line.find(mark, at)) != std::string::npos;)
      line.insert(at + 1, " ");
  return line;
}

data list() { return data{data::type::list}; }
data object() { return data{data::type::object}; }

/// The list with a comma for all of its items but the last.
data with_commas(std::vector<data> items) {
  data all = list();
  for (std::size_t i = 0; i < items.size(); ++i) {
    items[i].set("comma", i + 1 < items.size() ? "," : "");
    all.push_back(items[i]);
  }
  return all;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// s. The longest inner steps, by what fast modes allow: with double the difference to our
/// simulation is to stay below 1e-9 of a signal's range, with float below 1e-4. What decays is
/// forgotten, what oscillates adds up.
struct InnerSteps {
  double of_double = 2e-4, of_float = 1e-3;
};

InnerSteps inner_steps_for(const Model<double>& model) {
  const Equations<double> equations(model);
  InnerSteps steps;
  for (const bool touches : {false, true})
    for (const bool limited : {false, true}) {
      Mode mode;
      mode.sliding = 1;
      mode.contact = touches;
      mode.v_c = limited;
      mode.v_m = limited;
      const Matrix<double> a = system_matrix(equations, mode);
      Eigen::MatrixXd full(kStates, kStates);
      for (std::size_t i = 0; i < kStates; ++i)
        for (std::size_t j = 0; j < kStates; ++j)
          full(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = a[i][j];
      for (const std::complex<double>& root : eigenvalues(full)) {
        const double rate = std::abs(root);
        const bool oscillates = std::abs(root.imag()) > 0.1 * rate;
        steps.of_double = std::min(steps.of_double, (oscillates ? 0.06 : 0.1) / rate);
        steps.of_float = std::min(steps.of_float, (oscillates ? 0.3 : 0.5) / rate);
      }
    }
  return steps;
}

/// The data for the templates.
class Filling {
 public:
  Filling(const Rig& rig, const std::string& name) : model_(rig.model), all_(object()) {
    normalize(model_);
    values_ = members(model_);
    const Equations<double> equations(model_);
    const ActiveTerms& is = equations.parts();
    add_names(rig, name);
    add_flags(is, equations.states());
    add_parameters(is);
    add_signals(is);
    add_channels();
    const InnerSteps steps = inner_steps_for(model_);
    all_.set("inner_step", fmt::format("{:.3g}", steps.of_double));
    all_.set("inner_step_of_float", fmt::format("{:.3g}", steps.of_float));
  }
  data& all() { return all_; }

 private:
  const Structure& structure() const { return model_.structure; }
  Vocabulary vocabulary() const { return vocabulary_of(model_.structure); }
  void flag(const std::string& name, bool value) {
    if (value) all_.set(name, true);
  }

  void add_names(const Rig& rig, const std::string& name) {
    all_.set("name", name);
    all_.set("NAME", upper(name));
    all_.set("title", rig.name.empty() ? "a fitted axis" : in_comment(rig.name));
    all_.set("two_pi", real(2.0 * std::numbers::pi));
    const std::string_view unit = unit_on(vocabulary(), kCommandUnit);
    all_.set("command_unit", std::string(unit == "1" ? "share of the rating" : unit));
  }

  void add_flags(const ActiveTerms& is, std::size_t states) {
    const auto has = [&](std::string_view effect) {
      return is.effects[effect_named(effect).value()];
    };
    const auto has_any = [&](std::initializer_list<std::string_view> names) {
      return std::ranges::any_of(names, has);
    };
    flag("turns", structure().joint == Joint::revolute);
    flag("backlash", is.has.has_backlash);
    flag("electric", is.has.is_electric);
    flag("voltage_loop", is.has.has_voltage_loop);
    flag("current_loop", is.has.is_electric && !is.has.has_voltage_loop);
    flag("back_emf", is.has.has_back_emf);
    flag("has_current", is.has.has_current());
    flag("rigid_motor", is.has.has_motor && !is.has.has_backlash);
    flag("lagging", is.lagging);
    flag("directions", is.directions);
    flag("static_friction", is.static_friction);
    all_.set("doublet", is.static_friction ? "a->doublet" : "0");
    flag("driven_load", is.driven_load);
    flag("load_switches", is.driven_load && is.has.is_direct() && !is.lagging);
    flag("has_guards", is.has.has_backlash || is.has.is_electric || is.directions);
    flag("needs_between", is.has.has_backlash || is.has.is_electric);
    flag("needs_side", is.has.has_backlash || is.has.is_electric || is.directions);
    flag("motor_torque", is.needs.motor_torque);
    flag("drive_torque",
         has_any({"torque_ripple", "torque_droop", "force_droop", "torque_fade", "channel_gain"}));
    flag("arm_force", is.needs.arm_force);
    flag("friction_curve", is.needs.friction_curve);
    flag("hysteresis", is.needs.hysteresis);
    flag("needs_dahl", has_any({"dahl_friction", "second_dahl_friction"}));
    flag("needs_harmonics", has_any({"periodic_force", "second_periodic_force"}));
    flag("needs_load",
         has_any({"load_friction", "quadratic_load_friction", "stribeck_load_friction"}));
    flag("needs_direction",
         is.needs.hysteresis || has_any({"stribeck_friction", "stribeck_load_friction",
                                         "directional_friction", "friction_over_velocity"}));
    flag("needs_exp",
         has_any({"dahl_friction", "second_dahl_friction", "warming_grease", "stribeck_friction",
                  "friction_bump", "stribeck_load_friction", "warming_friction",
                  "running_in_friction", "torque_fade", "payload_change"}));
    flag("needs_pow",
         has_any({"stribeck_friction", "quadratic_drag", "torque_droop", "force_droop"}));
    flag("needs_sin", has_any({"cogging_torque", "torque_ripple", "pendulum_gravity",
                               "periodic_force", "second_periodic_force"}));
    flag("needs_floor", has("force_over_motor_angle"));
    flag("dead_time", model_.axis.T_d > 0.0);
    all_.set("state_count", std::to_string(states + 1));
  }

  bool is_parameter(const QuantityEntry& entry, const ActiveTerms& is) const {
    if (entry.signal || entry.group == "controller" || entry.group == "initial") return false;
    if (entry.effect && !is.effects[*entry.effect]) return false;
    if (entry.index == quantity_index("F_s") || entry.index == quantity_index("w"))
      return is.static_friction;
    if (entry.index == quantity_index("T_d")) return model_.axis.T_d > 0.0;
    return is_used(entry, structure());
  }

  void add_parameters(const ActiveTerms& is) {
    std::vector<data> parameters;
    const std::vector<QuantityEntry>& own = quantity_list(vocabulary());
    std::vector<std::string> names(own.size());  // of the members
    for (const QuantityEntry& entry : own) {
      if (!is_parameter(entry, is)) continue;
      names[entry.index] = identifier(entry.name);
      data& item = parameters.emplace_back(object());
      item.set("member", names[entry.index]);
      item.set("unit", in_comment(entry.quantity.unit));
      item.set("meaning", in_comment(entry.quantity.meaning));
      item.set("value", real(*values_[entry.index]));
    }
    all_.set("parameters", with_commas(std::move(parameters)));

    // How the templates call them: by the names of the sources.
    std::vector<data> force_curves, friction_curves;
    for (std::size_t e = 0; e < kEffects; ++e) {
      if (!is.effects[e]) continue;
      const std::string effect(kEffectTable[e].name);
      data one = object(), terms = list();
      std::vector<std::string> coefficients;
      for (const QuantityEntry& entry : quantity_list()) {
        if (entry.effect != e || names[entry.index].empty()) continue;
        const std::string symbol(entry.quantity.symbol),
            member = "parameters." + names[entry.index];
        one.set(symbol, member);
        if (symbol == "n" && *values_[entry.index] != entry.quantity.default_value)
          one.set("has_exponent", true);
        if (symbol == "a_t" && *values_[entry.index] != 0.0) one.set("has_time_constant", true);
        if (const auto channel = entry.quantity.channel) {
          data term = object();
          term.set("k", member);
          term.set("j", std::to_string(*channel));
          terms.push_back(term);
        } else if (!entry.quantity.shape) {
          coefficients.push_back("a->" + member);
        }
      }
      one.set("terms", terms);
      all_.set(effect, one);
      if (effect.find("_over_") != std::string::npos)
        add_curve(effect, names, coefficients,
                  effect.starts_with("friction") ? friction_curves : force_curves);
    }
    all_.set("force_curves", with_commas(force_curves));
    all_.set("friction_curves", with_commas(friction_curves));
    flag("has_curves", !force_curves.empty() || !friction_curves.empty());
    for (const QuantityEntry& entry : quantity_list())
      if (entry.group.empty()) all_.set(entry.name, names[entry.index]);

    std::vector<data> initial;
    for (std::size_t i = 0; i < kPaperStates; ++i) {
      if (model_.initial[i] == 0.0) continue;
      data& item = initial.emplace_back(object());
      item.set("index", std::to_string(i));
      item.set("value", real(model_.initial[i]));
    }
    all_.set("initial", with_commas(initial));
    if (!names[quantity_index("r_g")].empty()) {
      const std::string member = "p->" + names[quantity_index("r_g")];
      all_.set("radius", structure().gearing == Gearing::radius ? member
                         : structure().joint == Joint::prismatic
                             ? member + " / REAL(" + real(2.0 * std::numbers::pi) + ")"
                             : "REAL(1) / " + member);
    }
  }

  void add_curve(const std::string& effect, const std::vector<std::string>& names,
                 const std::vector<std::string>& coefficients, std::vector<data>& curves) {
    using Curve = ForceOverPosition<double>;
    const auto member = [&](const char* symbol) {
      return "a->parameters." + names[quantity_index(effect + "." + symbol)];
    };
    data& item = curves.emplace_back(object());
    item.set("label", effect);
    item.set("coefficients", fmt::format("{}", fmt::join(coefficients, ", ")));
    const std::string over = effect.substr(effect.find("_over_") + 6);
    all_.set("curve_coefficients", std::to_string(Curve::kCoefficients));
    all_.set("curve_intervals", std::to_string(Curve::kIntervals));
    if (over == "motor_angle") {
      item.set("call", "closed_curve(c, y[2])");
      flag("has_closed_curve", true);
      return;
    }
    const std::string variable = over == "position"               ? "y[0]"
                                 : over == "time"                 ? "y[TIME]"
                                 : effect.starts_with("friction") ? "REAL(direction(a)) * y[1]"
                                                                  : "y[1]";
    item.set("call", fmt::format("curve(c, {}, {}, {})", member("from"), member("to"), variable));
    flag("has_open_curve", true);
  }

  void add_signals(const ActiveTerms& is) {
    const auto truth = [&](Signal signal) -> std::string {
      switch (signal) {
        case Signal::position:
          return is.effects[effect_named("soft_transmission").value()]
                     ? "encoder_position(a, y)"
                     : "radius(&a->parameters) * y[2]";
        case Signal::velocity:
          return "y[1]";
        case Signal::acceleration:
          return "acceleration(a, y)";
        case Signal::tachometer:
          return fmt::format("a->parameters.{} * y[3]",
                             quantity_list(vocabulary())[quantity_index("K_t")].name);
        case Signal::motor_current:
          return "current(a, y)";
        case Signal::preamplifier_voltage:
          return "preamplifier_voltage(a, y)";
        case Signal::motor_voltage:
          return "motor_voltage(a, y)";
        case Signal::drive_force:
          return "drive_force(a, y)";
        case Signal::load_position:
          return "y[0]";
      }
      return "REAL(0)";
    };
    std::vector<data> signals;
    for (const SignalInfo& entry : kSignalTable) {
      if (!has_signal(entry.signal, structure())) continue;
      const SignalInfo on = info(entry.signal, vocabulary());
      const Instrument<double>& instrument = model_.instruments[index_of(entry.signal)];
      std::string reading = truth(entry.signal);
      if (instrument.gain != 1.0)
        reading = fmt::format("REAL({}) * ({})", real(instrument.gain), reading);
      if (instrument.bias != 0.0) reading += fmt::format(" + REAL({})", real(instrument.bias));
      data& item = signals.emplace_back(object());
      item.set("constant", upper(identifier(std::string(on.name))));
      item.set("label", std::string(on.name));
      item.set("unit", std::string(on.unit));
      item.set("meaning", std::string(on.meaning));
      item.set("reading", reading);
    }
    all_.set("signal_count", std::to_string(signals.size()));
    all_.set("signals", with_commas(signals));
  }

  void add_channels() {
    if (structure().channels == nullptr || structure().channels->empty()) {
      all_.set("argument_count", "2");
      all_.set("input_count", "1");
      return;
    }
    const ChannelList& channels = *structure().channels;
    std::vector<data> items;
    for (std::size_t j = 0; j < channels.size(); ++j) {
      data& item = items.emplace_back(object());
      item.set("label", channels[j].name);
      item.set("unit", in_comment(channels[j].unit));
      item.set("zero", real(channels[j].zero));
      item.set("j", std::to_string(j));
    }
    flag("has_channels", true);
    all_.set("channels", with_commas(items));
    all_.set("channel_count", std::to_string(channels.size()));
    all_.set("argument_count", "3");
    all_.set("input_count", std::to_string(1 + channels.size()));
  }

  Model<double> model_;
  std::vector<double*> values_;
  data all_;
};

std::string filled(std::string_view text, const data& all) {
  // Of a line that is nothing but a tag the library leaves an empty one: such lines end in a mark
  // instead, which is taken away afterwards.
  constexpr char kMark = '\x01';
  std::istringstream lines{std::string(text)};
  std::string marked;
  for (std::string line; std::getline(lines, line);) {
    const bool is_tag =
        (line.starts_with("<%") && line.find("%>") + 2 == line.size()) || line.starts_with("{{=");
    marked += line + (is_tag ? kMark : '\n');
  }
  kainjow::mustache::mustache form{marked};
  form.set_custom_escape([](const std::string& plain) { return plain; });
  if (!form.is_valid()) throw std::logic_error(form.error_message());
  std::string made = form.render(all);
  std::erase(made, kMark);
  return made;
}

}  // namespace

Export c_code(const Rig& rig, const std::string& of_file, const std::string& origin) {
  const std::string name = identifier(of_file);
  Export made = stepped(rig);
  Filling filling(made.carried, name);
  data lost = list();
  for (const std::string& sentence : made.lost) lost.push_back(sentence);
  filling.all().set("origin", in_comment(origin));
  filling.all().set("lost", lost);
  for (const auto& [ending, form] : {std::pair(".h", embedded_axis_h()),
                                     {".c", embedded_axis_c()},
                                     {"_mex.c", embedded_mex_c()},
                                     {"_sfun.c", embedded_sfun_c()}})
    made.files.emplace_back(name + ending, filled(form, filling.all()));
  return made;
}

}  // namespace axisfit
