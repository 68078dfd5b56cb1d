#include "apps/report_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "sim/table.h"

namespace axisfit {
namespace {

/// Rows of text as columns: the first and all named `left` are flush left, the others flush right.
std::string aligned(const std::vector<std::vector<std::string>>& rows,
                    const std::vector<bool>& left) {
  // Width in characters; units may contain multi-byte ones.
  const auto width_of = [](const std::string& text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
  };
  std::vector<std::size_t> width(left.size(), 0);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], width_of(row[c]));
  std::string text;
  for (const auto& row : rows) {
    std::string line = " ";
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string pad(width[c] - width_of(row[c]), ' ');
      line.append(1, ' ')
          .append(left[c] ? row[c] : pad)
          .append(left[c] ? pad : row[c])
          .append(1, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

/// A value with as many digits as its standard error justifies: two of the error.
std::string with_digits_of(double value, double error) {
  if (!(error > 0.0) || !std::isfinite(error)) return fmt::format("{:.4g}", value);
  const int last = static_cast<int>(std::floor(std::log10(error))) - 1;
  const int first = value == 0.0 ? last : static_cast<int>(std::floor(std::log10(std::abs(value))));
  const int digits = std::clamp(first - last + 1, 1, 15);
  // Plain figures where they are readable, powers of ten elsewhere.
  if (last <= 0 && first < 7 && first > -4)
    return fmt::format("{:.{}f}", value, std::min(-last, 12));
  if (last > 0 && first < 5) return fmt::format("{:.0f}", value);
  return fmt::format("{:.{}e}", value, digits - 1);
}

std::string recordings_text(const Job& job) {
  std::vector<std::vector<std::string>> rows;
  for (const Recording& r : job.recordings) {
    std::string signals;
    for (const Measurement& m : r.measurements)
      signals += (signals.empty() ? "" : ", ") + std::string(info(m.signal).name);
    rows.push_back({r.role == Role::fit ? "fit" : "validate", r.name,
                    fmt::format("{} samples", r.times.size()),
                    fmt::format("{:.4g} s to {:.4g} s", r.times.front(), r.times.back()), signals});
  }
  return "Recordings\n" + aligned(rows, {true, true, false, true, true});
}

std::string parameters_text(const Job& job, const FitResult& result) {
  std::vector<std::vector<std::string>> rows{
      {"", "", "value", "std. error", "95 % interval", "initial", "unit", ""}};
  for (std::size_t i = 0; i < job.free.size(); ++i) {
    const ParameterResult& p = result.parameters[i];
    const ParameterUncertainty& u = p.uncertainty;
    const Quantity& quantity = quantity_list()[job.free[i].quantity].quantity;
    const double error = u.determined ? u.standard_error : 0.0;
    const bool open = !u.determined && !u.at_bound;
    rows.push_back({p.name, std::string(quantity.meaning),
                    open ? fmt::format("~{:.1g}", p.value) : with_digits_of(p.value, error),
                    u.determined ? fmt::format("{:.2g}", error) : "-",
                    u.determined ? fmt::format("{} .. {}", with_digits_of(u.lower, error),
                                               with_digits_of(u.upper, error))
                                 : "-",
                    fmt::format("{:.4g}", job.free[i].initial), std::string(quantity.unit),
                    u.at_bound ? "at bound"
                    : open     ? "not determined"
                               : ""});
  }
  return "Parameters\n" + aligned(rows, {true, true, false, false, false, false, true, true});
}

std::string errors_text(const Job& job, const FitResult& result) {
  const bool prediction = job.options.coupling == CouplingMode::fixed;
  std::vector<std::vector<std::string>> rows{
      {"", "", "", "rmse", "of range", "noise", "red. chi2", "unit", ""}};
  if (prediction) rows.front().back() = "predicted rmse";
  for (std::size_t r = 0; r < job.recordings.size(); ++r) {
    const Recording& recording = job.recordings[r];
    for (const SignalError& e : result.recordings[r].signals) {
      const bool finished = result.recordings[r].prediction.finished;
      rows.push_back({recording.name,
                      recording.role == Role::validate ? "validate"
                      : e.fitted                       ? "fit"
                                                       : "compare",
                      std::string(info(e.signal).name),
                      finished ? fmt::format("{:.4g}", e.rmse) : "-",
                      finished ? fmt::format("{:.3g} %", e.nrmse_percent) : "-",
                      fmt::format("{:.3g}{}", e.sigma, e.sigma_given ? "" : "*"),
                      finished ? fmt::format("{:.4g}", e.reduced_chi_square) : "-",
                      std::string(info(e.signal).unit),
                      e.prediction_rmse ? fmt::format("{:.4g}", *e.prediction_rmse) : ""});
    }
  }
  std::string text = "Errors of the free-running simulation\n" +
                     aligned(rows, {true, true, true, false, false, false, false, true, false});
  const bool estimated = std::ranges::any_of(job.recordings, [](const Recording& r) {
    return std::ranges::any_of(r.measurements, [](const Measurement& m) { return !m.sigma_given; });
  });
  if (estimated) text += "  * estimated from differences of the samples\n";
  return text;
}

}  // namespace

std::string report_text(const JobFile& file, const FitResult& result) {
  const Job& job = file.job;
  const std::string assumption =
      result.reduced_chi_square > 1.0
          ? fmt::format("independent residuals of the size found, {:.3g} times the noise",
                        std::sqrt(result.reduced_chi_square))
          : "independent noise of the size stated below";
  return fmt::format("{}\n{}  Standard errors assume {}.\n\n{}\n{}\n", recordings_text(job),
                     parameters_text(job, result), assumption, errors_text(job, result),
                     result.verdict);
}

std::string residuals_csv(const Job& job, const FitResult& result) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Table table;
  std::size_t rows = 0;
  for (const Recording& r : job.recordings) rows += r.times.size();
  std::vector<double> number, time;
  for (std::size_t r = 0; r < job.recordings.size(); ++r)
    for (const double t : job.recordings[r].times) {
      number.push_back(static_cast<double>(r + 1));
      time.push_back(t);
    }
  table.columns = {{"recording", number}, {"time_s", time}};
  for (const SignalInfo& signal : kSignalTable) {
    Column measured{std::string(signal.name) + "_measured", {}},
        simulated{std::string(signal.name) + "_simulated", {}},
        residual{std::string(signal.name) + "_residual", {}};
    bool recorded = false;
    for (std::size_t r = 0; r < job.recordings.size(); ++r) {
      const Recording& recording = job.recordings[r];
      const auto m = std::ranges::find(recording.measurements, signal.signal, &Measurement::signal);
      const bool present = m != recording.measurements.end();
      recorded = recorded || present;
      const auto index = static_cast<std::size_t>(m - recording.measurements.begin());
      for (std::size_t i = 0; i < recording.times.size(); ++i) {
        const double y = present ? m->values[i] : kNone;
        const bool reached = present && i < result.recordings[r].prediction.simulated[index].size();
        const double s = reached ? result.recordings[r].prediction.simulated[index][i] : kNone;
        measured.values.push_back(y);
        simulated.values.push_back(s);
        residual.values.push_back(y - s);
      }
    }
    if (!recorded) continue;
    for (Column* c : {&measured, &simulated, &residual}) table.columns.push_back(std::move(*c));
  }
  std::ostringstream out;
  write_csv(out, table, 9);
  return out.str();
}

}  // namespace axisfit
