#include "apps/result_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/version.h"
#include "io/config/axis_file.h"
#include "io/config/motion_file.h"
#include "io/config/next_job.h"
#include "report/html/report_page.h"
#include "report/text/report_text.h"
#include "report/text/words.h"

namespace axisfit {
namespace {

const ResultName kResult{std::string(kResultFile), "\"axisfit\": \""};
const ResultName kAxisFile{"fitted.yaml", "# Fitted by axisfit "};
const ResultName kResidualsFile{"residuals.csv", "recording,time_s,"};
const ResultName kReportFile{"report.html", "<meta name=\"generator\" content=\"axisfit "};
const ResultName kPredictionFile{"prediction.csv", "recording,time_s,"};
const ResultName kPredictedMotionFile{"predicted-motion.csv", "time_s,"};
const ResultName kMotionFile{"next-motion.yaml", "# Suggested by axisfit "};
const ResultName kNextJobFile{"next-job.yaml", "# Goes on from axisfit "};

/// Whether effects were accepted, or constants found to be others.
bool declares_too_little(const Job& declared, const Job& reached) {
  return reached.free.size() != declared.free.size() ||
         reached.model.structure.effects != declared.model.structure.effects;
}

}  // namespace

std::vector<ResultName> result_names() {
  return {kResult,     kAxisFile,       kResidualsFile,
          kReportFile, kPredictionFile, kPredictedMotionFile,
          kMotionFile, kNextJobFile};
}

Files result_files(const JobFile& file, const RunResult& run_result, const std::string& json,
                   const ResultOrigin& origin) {
  Rig fitted = file.rig;
  fitted.model = fitted_model(run_result.job(), run_result.fit());
  fitted.uncertainty = run_result.uncertainty;
  // What was estimated is no guess any more.
  std::erase_if(fitted.guessed, [&](std::size_t g) {
    return std::ranges::count(run_result.job().free, g, &FreeParameter::quantity) > 0;
  });
  const std::string made_by =
      fmt::format("axisfit {} from {}, starting from {}", version(), origin.job, file.axis_file);
  Files files{{kResult.name, json},
              {kAxisFile.name, format_axis_file(fitted, fmt::format("Fitted by {}.\n{}", made_by,
                                                                    overall_verdict(run_result)))},
              {kResidualsFile.name,
               residuals_csv(run_result.job(), run_result.fit(), run_result.diagnosis)},
              {kReportFile.name, report_page(run_result, {origin.command, origin.job, file.text,
                                                          file.axis_file, file.axis_text})}};
  if (!origin.output.empty() && declares_too_little(file.job, run_result.job()))
    files.emplace_back(
        kNextJobFile.name,
        next_job_text(file, run_result.job(), origin.job, origin.data, origin.output,
                      kAxisFile.name,
                      fmt::format("Goes on from {}, with what was accepted there: the axis is {}.",
                                  made_by, kAxisFile.name)));
  if (!run_result.predictions.empty())
    files.emplace_back(kPredictionFile.name, prediction_csv(run_result));
  if (run_result.motion) files.emplace_back(kPredictedMotionFile.name, motion_csv(run_result));
  const Vocabulary vocabulary = run_result.job().vocabulary();
  if (const Experiment* next = next_experiment(run_result)) {
    files.emplace_back(kMotionFile.name,
                       format_motion_file({next->motion, next->duration},
                                          fmt::format("Suggested by {}:\n{}.", made_by,
                                                      motion_text(next->motion, vocabulary)),
                                          vocabulary));
  }
  return files;
}

}  // namespace axisfit
