#include <algorithm>
#include <stdexcept>

#include "base/parallel.h"
#include "sim/ensemble.h"
#include "sim/rig.h"
#include "sim/rig_run.h"

namespace axisfit {

std::vector<Column> record_with_bands(const Rig& rig, const Motion& motion,
                                      const RecordingOptions& options) {
  if (!rig.uncertainty)
    throw std::runtime_error(
        "the axis file does not say how uncertain its parameters are: bands are "
        "for the fitted.yaml that fit-params writes");
  const AxisEnsemble ensemble(*rig.uncertainty, rig.model.structure, options.seed);
  RecordingOptions exact = options;
  exact.noise = false;
  std::vector<Column> columns = record(rig, motion, exact);
  const std::size_t first = columns.size() - options.signals.size();

  constexpr double kParts = 4.0;  // as instruments with lags divide the intervals
  const std::vector<double> instants = sampling_times(options, kParts);
  std::vector<std::vector<Column>> drawn(AxisEnsemble::kDraws);
  parallel_for(drawn.size(), [&](std::size_t k) {
    Rig of_draw = rig;
    of_draw.model = ensemble.axis(rig.model, k);
    RecordingOptions own = options;
    own.seed += 1 + k;
    std::vector<ChannelSeries> series;
    if (ensemble.has_missing_force()) {
      series.resize(of_draw.model.structure.channels->size() - 1,
                    {std::vector<double>(instants.size(), 0.0)});
      series.push_back({ensemble.missing_force(k, instants)});
    }
    try {
      drawn[k] = record(of_draw, motion, own,
                        series.empty() ? ChannelsOverTime{} : ChannelsOverTime{instants, series});
    } catch (const std::runtime_error&) {
      // It cannot be simulated to the end.
    }
  });
  std::erase_if(drawn, [](const auto& of_draw) { return of_draw.empty(); });
  if (!AxisEnsemble::are_enough(drawn.size()))
    throw std::runtime_error("no band: only " + std::to_string(drawn.size()) + " of " +
                             std::to_string(AxisEnsemble::kDraws) +
                             " draws of the parameters could be simulated to the end; fit fewer "
                             "parameters, or record what determines them");
  std::vector<Column> with_bands(columns.begin(),
                                 columns.begin() + static_cast<std::ptrdiff_t>(first));
  for (std::size_t c = first; c < columns.size(); ++c) {
    std::vector<std::vector<double>> curves;
    for (auto& of_draw : drawn) curves.push_back(std::move(of_draw[c].values));
    const Band band = band_of(columns[c].values, curves);
    Column half{columns[c].name + "_half_width", band.half_width},
        whole{columns[c].name + "_half_width_of_whole", band.half_width};
    for (double& w : whole.values) w *= band.whole;
    for (Column* column : {&columns[c], &half, &whole}) with_bands.push_back(std::move(*column));
  }
  return with_bands;
}

}  // namespace axisfit
