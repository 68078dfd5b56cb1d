#include "report/text/names.h"

#include <fmt/format.h>

#include <cmath>

namespace axisfit {

std::string name_of(const Job& job, ParameterId id) {
  const std::string& name = job.entry(id.quantity).name;
  return id.recording ? name + "@" + job.recordings[*id.recording].name : name;
}

std::string name_of(const Job& job, const FreeParameter& free) { return name_of(job, free.id()); }

const Quantity& quantity_of(const Job& job, ParameterId id) {
  return job.entry(id.quantity).quantity;
}

std::string name_of(const Job& job, const Combination& combination) {
  const std::string first = name_of(job, job.free[combination.first]),
                    second = name_of(job, job.free[combination.second]);
  constexpr double kWhole = 0.05;
  if (std::abs(combination.exponent + 1.0) < kWhole) return first + " / " + second;
  if (std::abs(combination.exponent - 1.0) < kWhole) return first + " " + second;
  return fmt::format("{} {}^{:.2g}", first, second, combination.exponent);
}

std::string_view scale_name(Scale scale) {
  switch (scale) {
    case Scale::logarithmic:
      return "log";
    case Scale::from_zero:
      return "from_zero";
    case Scale::linear:
      break;
  }
  return "linear";
}

}  // namespace axisfit
