// What the fit of one axis on one night says: what trends are made of.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "fit/run.h"

namespace axisfit {

struct NightResult {
  struct Parameter {
    std::string name, unit;
    double value = 0.0;
    double standard_error = 0.0;  ///< within the night; of those that are determined
  };
  struct Residual {
    std::string recording, signal, unit, role;
    double rmse = 0.0, chi_square = 0.0;
  };
  struct Channel {
    std::string name;
    double mean = 0.0;  ///< over the night's recordings, in its unit
  };

  std::string axis, night;
  std::string status;                 ///< the grade of the fit, or "failed"
  std::string reason;                 ///< of what failed
  std::string fingerprint;            ///< of the inputs, as planned
  double seconds = 0.0;               ///< that it took, the only part that differs from run to run
  std::vector<Parameter> parameters;  ///< of the declared model, that are determined
  std::vector<Residual> residuals;    ///< of the declared model
  std::vector<std::string> effects;   ///< that were accepted, with what they are
  std::vector<Channel> channels;
};

/// Of a finished run that did not search for effects, so that nights can be compared whatever a
/// search makes of them. Axis, night and fingerprint are for the caller.
NightResult night_result(const RunResult& run);
/// Adds what a search for effects on the same recordings found: effects, grade and time.
void add_search(NightResult& night, const RunResult& run);

nlohmann::ordered_json to_json(const NightResult& result);
/// Throws nlohmann::json::exception for what to_json() did not make.
NightResult night_result_from(const nlohmann::ordered_json& json);

}  // namespace axisfit
