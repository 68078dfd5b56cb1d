// What a fit writes: result.json, fitted.yaml, residuals.csv, the report and what --check says, for
// jobs whose names and values come from the input. No number is lost or changed on the way to a
// reader of the files, and no name breaks them.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "fit/first_look/job_look.h"
#include "fit/run.h"
#include "fuzz/check.h"
#include "init/starter_axis.h"
#include "io/config/axis_file.h"
#include "io/config/job_file.h"
#include "report/html/report_page.h"
#include "report/result_json.h"
#include "report/text/report_text.h"
#include "report/text/words.h"

namespace axisfit::fuzz {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kElement = "<b9>";  ///< that no page has of its own

/// Draws from the input, which is followed by zeros.
class Draw {
 public:
  explicit Draw(std::string_view input) : rest_(input) {}

  std::uint8_t byte() { return static_cast<std::uint8_t>(bytes(1)[0]); }
  std::size_t below(std::size_t n) { return byte() % n; }
  bool flag() { return below(2) == 1; }

  /// A number that recordings and jobs may hold.
  double number(double magnitude) {
    switch (below(4)) {
      case 0: {
        double x = 0.0;
        std::memcpy(&x, bytes(sizeof x).data(), sizeof x);
        return std::abs(x) <= 1e30 ? x : 0.0;
      }
      case 1:
        return 0.0;
      default:
        std::int16_t i = 0;
        std::memcpy(&i, bytes(sizeof i).data(), sizeof i);
        return magnitude * i / 32768.0;
    }
  }

  std::string bytes(std::size_t n) {
    std::string drawn(rest_.substr(0, n));
    rest_.remove_prefix(drawn.size());
    drawn.resize(n, '\0');
    return drawn;
  }

  /// A text of UTF-8; bytes that are not become characters of Latin-1.
  std::string text() {
    const bool any = below(16) == 1;  // usually none that a job refuses
    std::string text = bytes(below(32));
    for (std::size_t at; (at = find_invalid_utf8(text)) != std::string::npos;) {
      const auto byte = static_cast<unsigned char>(text[at]);
      const char two[] = {static_cast<char>(0xC0 | byte >> 6),
                          static_cast<char>(0x80 | (byte & 0x3F)), 0};
      text.replace(at, 1, two);
    }
    if (below(4) == 1) text += kElement;
    return any ? text : sanitized(text);
  }

 private:
  std::string_view rest_;
};

/// As YAML writes any text.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F || c == '"' || c == '\\')
      result += fmt::format("\\x{:02x}", byte);
    else
      result += c;
  }
  return result + '"';
}

struct Names {
  std::string axis;
  std::vector<std::string> recordings, files;
};

std::string axis_text(Draw& draw, const std::string& name) {
  const std::string named = name.empty() ? "" : fmt::format("name: {}\n", quoted(name));
  switch (draw.below(8)) {
    case 0: {
      const std::string text(machine_axes().front().text);
      return named + text.substr(text.find("drive:"));
    }
    case 1:
      return named +
             "drive: force_source\ntransmission: rigid\n"
             "effects: {coulomb_friction: {F_c: 6 N}}\n"
             "parameters: {K_f: 10 N/V, M: 4 kg, B_a: 8 N s/m}\n";
    default:
      return named +
             "drive: force_source\ntransmission: rigid\n"
             "parameters: {K_f: 10 N/V, M: 4 kg, B_a: 8 N s/m}\n";
  }
}

/// A short recording of a velocity that answers to its command, more or less.
std::string csv_text(Draw& draw) {
  const std::size_t rows = 10 + draw.below(4);
  const double dt = std::abs(draw.number(0.01)) + 1e-3;
  const double start = draw.number(10.0), noise = draw.number(1.0);
  double v = 0.0, u = 2.0;
  std::string text = "t,u,v,a\n";
  for (std::size_t i = 0; i < rows; ++i) {
    const double chance = static_cast<double>((7 * i) % 5) - 2.0;
    if (draw.below(8) == 1) u = draw.number(10.0);
    v += (u - v) * std::min(1.0, 10.0 * dt);
    const double wrong = draw.below(8) == 1 ? draw.number(10.0) : noise * chance;
    text += fmt::format("{},{},{},{}\n", start + dt * static_cast<double>(i), u, v + wrong,
                        u - v + wrong);
  }
  return text;
}

std::string job_text(Draw& draw, const Names& names) {
  constexpr const char* kSigmas[] = {"", ", sigma: 1 mm/s", ", sigma: fit", ", sigma: 1e-9 m/s"};
  constexpr const char* kCouplings[] = {
      "none", "none", "none", "none", "none", "none", "{fixed: 100 1/s}", "continuation"};
  std::string text = "axis: axis.yaml\nrecordings:\n";
  for (std::size_t r = 0; r < names.files.size(); ++r)
    text += fmt::format(
        "  - file: {}\n    name: {}\n    role: {}\n    time: {{column: t, unit: s}}\n"
        "    signals:\n      command: {{column: u, unit: V}}\n"
        "      velocity: {{column: v, unit: m/s{}}}\n{}{}",
        quoted(names.files[r]), quoted(names.recordings[r]), r == 0 ? "fit" : "validate",
        kSigmas[draw.below(4)],
        draw.flag() ? "      acceleration: {column: a, unit: m/s^2, sigma: 0.1 m/s^2}\n" : "",
        draw.flag() ? "    initial_state: data\n    initial_samples: 4\n" : "");
  text += "free:\n  B_a: {}\n";
  if (draw.flag()) text += "  velocity.bias: {per_recording: true}\n";
  if (draw.flag()) text += "  velocity.delay: {}\n";
  if (draw.flag()) text += "  M: {prior: {mean: 4 kg, sigma: 1 kg}}\n";
  return text +
         fmt::format("fit: {{max_iterations: 1, starts: {}, seed: {}, observer: {}, loss: {}}}\n",
                     draw.below(8) == 1 ? 2 : 1, draw.byte(), kCouplings[draw.below(8)],
                     draw.flag() ? "huber" : "squares");
}

/// JSON has no other numbers; the library writes null for them.
void require_finite(const Json& value, const std::string& where) {
  if (value.is_number_float())
    require(std::isfinite(value.get<double>()), "a number is lost", where);
  if (value.is_structured())
    for (const auto& [key, entry] : value.items()) require_finite(entry, where + "/" + key);
}

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// Equal to the last bit, which == is not for zeros.
bool same(const Json& a, const Json& b) {
  if (a.is_number_float() && b.is_number_float()) return same(a.get<double>(), b.get<double>());
  if (a.type() != b.type() && !(a.is_number_integer() && b.is_number_integer())) return false;
  if (!a.is_structured()) return a == b;
  if (a.size() != b.size()) return false;
  for (auto p = a.begin(), q = b.begin(); p != a.end(); ++p, ++q)
    if ((a.is_object() && p.key() != q.key()) || !same(*p, *q)) return false;
  return true;
}

Json read_back(const Json& json) {
  require_finite(json, "");
  const std::string text = json.dump(2);
  require(find_invalid_utf8(text) == std::string::npos, "JSON is not UTF-8", text);
  const Json again = Json::parse(text);
  require(same(json, again), "JSON is not read again", text);
  return again;
}

void check_json(const RunResult& run_result, const Names& names) {
  const Json json = read_back(result_json(run_result));
  require(json.at("axis") == names.axis, "the axis has lost its name");
  for (std::size_t r = 0; r < names.files.size(); ++r) {
    require(json.at("recordings")[r].at("name") == names.recordings[r], "a recording's name");
    require(json.at("recordings")[r].at("file") == names.files[r], "a file's name is lost");
  }
  for (std::size_t i = 0; i < run_result.fit().parameters.size(); ++i)
    require(same(json.at("parameters")[i].at("value").get<double>(),
                 run_result.fit().parameters[i].value),
            "a value is lost");
}

void check_axis(const Folder& folder, Rig fitted, const RunResult& run_result,
                const std::string& typed) {
  fitted.model = fitted_model(run_result.job(), run_result.fit());
  const std::string text =
      format_axis_file(fitted, "Fitted from " + typed + ".\n" + overall_verdict(run_result));
  Diagnostics diagnostics;
  auto again = read_axis_file(folder.write("fitted.yaml", text), diagnostics);
  require(again.has_value(), "fitted.yaml is not read again",
          text + (diagnostics.empty() ? "" : diagnostics.sorted().front().text()));
  require(again->name == fitted.name, "fitted.yaml has lost the name", text);
  const auto p = members(fitted.model), q = members(again->model);
  for (std::size_t i = 0; i < p.size(); ++i)
    require(!is_used(quantity_list()[i], fitted.model.structure) || same(*p[i], *q[i]),
            "fitted.yaml has lost a value", text);
}

void check_residuals(const RunResult& run_result) {
  const std::string text = residuals_csv(run_result.job(), run_result.fit(), run_result.diagnosis);
  require_harmless(text, "residuals.csv is no text");
  std::size_t rows = 0;
  for (const Recording& r : run_result.job().recordings) rows += r.times.size();
  require(static_cast<std::size_t>(std::ranges::count(text, '\n')) == rows + 1,
          "residuals.csv has lost rows", text);
  require(text.find("nan") == std::string::npos && text.find("inf") == std::string::npos,
          "residuals.csv has what is no number", text);
}

void check_page(const std::string& page) {
  require(find_invalid_utf8(page) == std::string::npos, "the report is not UTF-8", page);
  const auto bad = std::ranges::find_if(page, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7F;
  });
  require(bad == page.end(), "the report has control characters", page);
  require(page.find(kElement) == page.npos, "a name is an element of the page", page);
}

/// A fit alone, without the look at its residual, which takes most of the time.
RunResult fitted(Job job) {
  RunResult run_result;
  run_result.first = estimate_with_noise(job);
  run_result.checks = check_recordings(job);
  run_result.baseline = std::move(job);
  return run_result;
}

void check(const Folder& folder, JobFile file, const Names& names, const std::string& job,
           Draw& draw) {
  // What was typed may be any bytes.
  const std::string typed = draw.bytes(draw.below(16));
  file.job.options.threads = 1;
  file.job.options.attempts = 1;
  file.job.options.step = 0.02;
  const Forecast forecast = axisfit::forecast(file.job, draw_start(file.job, 0));
  const auto checks = check_recordings(file.job);
  const auto look = look_at(file.job);
  read_back(axisfit::check_json(file.job, checks, look, forecast, {1.0, 1.0}));
  require_harmless(recordings_text(file.job, checks) + first_look_text(file.job, look) +
                       forecast_text(file.job, forecast),
                   "--check prints what a terminal cannot show");
  const RunResult run_result = draw.below(4) == 1 ? run(file.job, {}) : fitted(file.job);
  check_json(run_result, names);
  check_axis(folder, file.rig, run_result, typed);
  check_residuals(run_result);
  require_harmless(report_text(run_result), "the text has what a terminal cannot show");
  check_page(report_page(run_result, {typed, typed, job, typed, "axis"}));
}

}  // namespace

void check_input(const Folder& folder, std::string_view input) {
  folder.clear();
  Draw draw(input);
  Names names;
  names.axis = draw.text();
  for (std::size_t r = 0, n = 1 + draw.below(2); r < n; ++r) {
    // In a folder the names of files are free but for these two characters.
    std::string name = draw.text() + ".csv";
    std::ranges::replace(name, '/', '_');
    std::ranges::replace(name, '\0', '_');
    names.files.push_back(name);
    names.recordings.push_back(draw.text());
    folder.write(name, csv_text(draw));
  }
  folder.write("axis.yaml", axis_text(draw, names.axis));
  const std::string job = job_text(draw, names);
  std::optional<JobFile> file;
  refusable([&] { file = read_job_file(folder.write("job.yaml", job)); });
  if (file) check(folder, std::move(*file), names, job, draw);
}

}  // namespace axisfit::fuzz
