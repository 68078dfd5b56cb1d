// Small fits and what is told of them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "base/text_table.h"
#include "fit/run.h"
#include "io/config/job_file.h"
#include "report/result_json.h"
#include "report/text/report_text.h"
#include "tests/apps/files.h"
#include "tests/apps/fit_job.h"

namespace axisfit {

using Json = nlohmann::ordered_json;

inline std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> result;
  for (const auto& [key, value] : object.items()) result.push_back(key);
  return result;
}

/// Nobody has to scroll, and no line has blanks at its end.
inline void expect_narrow(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(width_of(line), 80u) << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
}

/// What was found for a job on the recordings of fit_job.h, and what is told of it.
struct Found {
  explicit Found(const std::string& job, bool close_the_loop = false) {
    const TempFolder folder;
    write_recordings(folder);
    write_rubbing_mass(folder);
    const JobFile file = read_job_file(folder.write("job.yaml", job));
    rig = file.rig;
    run_result = run(file.job, {.select_effects = close_the_loop});
    json = result_json(run_result);
    text = report_text(run_result);
    expect_narrow(text);
  }
  Rig rig;
  RunResult run_result;
  Json json;
  std::string text;
};

/// A CSV text with empty fields as NaN.
struct Csv {
  explicit Csv(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      std::vector<std::string> fields(1);
      for (const char c : line) {
        if (c == ',')
          fields.emplace_back();
        else
          fields.back() += c;
      }
      if (header.empty()) {
        header = fields;
        continue;
      }
      rows.emplace_back();
      for (const std::string& f : fields)
        rows.back().push_back(f.empty() ? std::nan("") : std::strtod(f.c_str(), nullptr));
    }
  }
  std::vector<std::string> header;
  std::vector<std::vector<double>> rows;
};

/// The job of the rubbing mass, before anything is fitted.
inline JobFile rubbing_file() {
  const TempFolder folder;
  write_rubbing_mass(folder);
  return read_job_file(folder.write("job.yaml", rubbing_job()));
}

/// Text in which runs of blanks and line ends are one blank.
inline std::string on_one_line(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) line += (line.empty() ? "" : " ") + word;
  return line;
}

/// A parameter that was found with this standard error; zero: the data leave it open.
inline ParameterResult estimated(const char* name, double value, double error) {
  ParameterUncertainty u;
  if (error > 0.0)
    u = {.determined = true,
         .standard_error = error,
         .lower = value - 2.0 * error,
         .upper = value + 2.0 * error};
  return {{quantity_index(name)}, value, u};
}

}  // namespace axisfit
