#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/rounding.h"
#include "base/text_table.h"
#include "base/units.h"
#include "report/text/report_text.h"
#include "report/text/words.h"

namespace axisfit {
namespace {

/// A number for the eye.
std::string short_number(double value) { return fmt::format("{:.4g}", value); }

std::string header_text(const Recording& recording, const Sampling& sampling) {
  std::string text = fmt::format(
      "{} ({}): {} samples in {} s, {} Hz", recording.name, role_name(recording, true),
      sampling.samples, short_number(sampling.duration), short_number(1.0 / sampling.interval));
  if (sampling.jitter > 1e-3) text += fmt::format(", jitter {:.2g} %", 100.0 * sampling.jitter);
  text += sampling.gaps == 0   ? ", no gaps"
          : sampling.gaps == 1 ? ", one gap"
                               : fmt::format(", {} gaps", sampling.gaps);
  return paragraph(text);
}

}  // namespace

std::string recordings_text(const Job& job, const std::vector<RecordingCheck>& checks) {
  std::string text = "What the recordings show\n";
  for (std::size_t r = 0; r < checks.size(); ++r) {
    const Recording& recording = job.recordings[r];
    const RecordingCheck& check = checks[r];
    text += header_text(recording, check.sampling);
    const bool force = drives_by_force(recording, job.model);
    const bool is_reference = recording.command.meaning == Meaning::reference;
    std::vector<std::vector<std::string>> rows{
        {"", "lowest", "highest", "unit", "sigma", "noise", "resolution", ""}};
    rows.push_back(
        {is_reference ? "position_reference"
         : force      ? std::string(words_on(job.vocabulary(), "drive_force"))
                      : "command",
         short_number(check.command.low), short_number(check.command.high),
         std::string(unit_on(job.vocabulary(), is_reference ? "m"
                                               : force      ? "N"
                                                            : kCommandUnit)),
         recording.command_sigma > 0.0 ? fmt::format("{:.2g}", recording.command_sigma) : "", "",
         "", fmt::format("{} switches", check.switches)});
    const double largest = std::max(std::abs(check.command.low), std::abs(check.command.high));
    if (!force && !is_reference && largest >= job.model.controller.gains.limit &&
        check.at_maximum > 0.01)
      rows.back().back() = fmt::format("at limit {:.0f} %", 100.0 * check.at_maximum);
    for (std::size_t m = 0; m < check.measurements.size(); ++m) {
      const ValueCheck& values = check.measurements[m];
      const Measurement& measurement = recording.measurements[m];
      std::string remark = measurement.fitted ? "" : "not fitted";
      for (const RateCheck& rate : check.rates)
        if (rate.rate == measurement.signal)
          remark = fmt::format("{:.4g} x d/dt", rate.found.ratio);
      const SignalInfo signal = info(measurement.signal, job.vocabulary());
      rows.push_back({std::string(signal.name), short_number(values.low), short_number(values.high),
                      std::string(signal.unit), fmt::format("{:.2g}", measurement.sigma),
                      fmt::format("{:.2g}", values.noise),
                      values.resolution > 0.0 ? fmt::format("{:.3g}", values.resolution) : "none",
                      remark});
    }
    text +=
        format_table(rows, {Alignment::left, Alignment::right, Alignment::right, Alignment::left,
                            Alignment::right, Alignment::right, Alignment::right, Alignment::left});
    for (const std::string& warning : warnings_for(job, recording, check))
      text += paragraph("! " + warning, 2);
  }
  return text;
}

std::string first_look_text(const Job& job, const std::optional<FirstLook>& look) {
  if (!look || !look->shows_anything()) return {};
  const Vocabulary vocabulary = job.vocabulary();
  const std::string force(words_on(vocabulary, "drive force"));
  std::vector<std::string> seen;
  const auto see = [&](const char* quantity, const FirstLook::Term& term) {
    if (!(std::abs(term.distance()) > FirstLook::kSure)) return;
    const QuantityEntry& entry = job.entry(quantity_index(quantity));
    seen.push_back(fmt::format(
        "{} {}", entry.name,
        with_unit(with_digits_of(term.value, term.error) + fmt::format(" +- {:.2g}", term.error),
                  entry.quantity.unit)));
  };
  see("M", look->mass);
  see("B_a", look->viscous);
  see("coulomb_friction.F_c", look->coulomb);
  FirstLook::Term acting = look->constant;  // the balance has it on the other side
  acting.value = -acting.value;
  see("constant_force.F_0", acting);
  std::string text = fmt::format(
      "A first look at the forces of all recordings, by one mass with friction and without a "
      "simulation: {}. It leaves {} of the {}.",
      fmt::join(seen, ", "), percent(100.0 * look->unexplained), force);
  const double interval = sampling(job.recordings.front().times).interval;
  if (look->shows_delay(interval))
    text += fmt::format(" The motion {} the {} by {:.2g} ms.",
                        look->delay.value > 0.0 ? "follows" : "is logged before", force,
                        1e3 * std::abs(look->delay.value));
  text = paragraph(text);
  if (look->direction == FirstLook::Direction::turned)
    text += paragraph("! As declared, friction would drive the axis: turn the " + force +
                          " by 'sign: -1' in the job.",
                      2);
  return text;
}

std::string run_time_text(const Job& job, const RunTimeEstimate& run_time) {
  const auto text = [](double seconds) {
    return seconds < 90.0 ? fmt::format("{:g} s", round_to_digits(seconds, 1))
                          : fmt::format("{:g} min", round_to_digits(seconds / 60.0, 1));
  };
  const int threads = thread_count(job.options.threads);
  return paragraph(fmt::format(
      "Estimated run time on this machine with {} thread{}: {} if the model explains the "
      "recordings, otherwise {}. With --close-loop: {} if nothing is missing, {} if one effect is, "
      "and {} or more if no effect suffices.",
      threads, threads == 1 ? "" : "s", text(run_time.explained), text(run_time.unexplained),
      text(run_time.nothing_missing), text(run_time.one_effect), text(run_time.no_effect)));
}

}  // namespace axisfit
