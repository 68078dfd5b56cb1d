#include <fmt/format.h>

#include "base/text_table.h"
#include "base/units.h"
#include "report/text/report_text.h"

namespace axisfit {
namespace {

std::string with_error(const Estimated& found, const std::string& unit) {
  return fmt::format("{} +- {:.2g} {}", with_digits_of(found.value, found.error), found.error,
                     unit);
}

}  // namespace

std::string couplings_text(const std::vector<SharedInertia>& shared) {
  if (shared.empty()) return {};
  constexpr double kFar = 4.0;
  std::string text = "Couplings\n";
  for (const SharedInertia& s : shared)
    text += paragraph(
        fmt::format("{} and {} share an inertia of {}: by the recordings of {} {}, by those of {} "
                    "{}, {:.1f} standard errors apart{}.",
                    s.one, s.other, with_error(s.both, s.unit), s.one,
                    with_error(s.from_one, s.unit), s.other, with_error(s.from_other, s.unit),
                    s.apart,
                    s.apart > kFar ? "; that is too far for one inertia: something else goes with "
                                     "these accelerations"
                                   : ""),
        2);
  return text;
}

}  // namespace axisfit
