#include "exports/export.h"

#include <fmt/format.h>

#include <cctype>
#include <stdexcept>

#include "exports/targets.h"

namespace axisfit {

std::string identifier(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return std::isalpha(static_cast<unsigned char>(name.front())) != 0 ? name : "axis_" + name;
}

Export stepped(const Rig& rig) {
  Export made{{}, rig, {}};
  Model<double>& model = made.carried.model;
  if (model.axis.T_d < 0.0) {
    made.lost.emplace_back(
        "The dead time of the command (T_d) below zero is left out: it would "
        "take commands that have not been given.");
    model.axis.T_d = 0.0;
  }
  for (const SignalInfo& entry : kSignalTable) {
    Instrument<double>& instrument = model.instruments[index_of(entry.signal)];
    if (!has_signal(entry.signal, model.structure) ||
        (instrument.lag == 0.0 && instrument.delay == 0.0 && instrument.drift == 0.0))
      continue;
    made.lost.push_back(fmt::format("Lag and delay of the instrument of {} are left out.",
                                    info(entry.signal, vocabulary_of(model.structure)).name));
    instrument.lag = instrument.delay = instrument.drift = 0.0;
  }
  if (rig.uncertainty) made.lost.emplace_back(kUncertaintyIsLost);
  return made;
}

Export export_axis(const Rig& rig, ExportTarget target, const std::string& name,
                   const std::string& origin) {
  switch (target) {
    case ExportTarget::fmu2:
      return fmu(rig, FmiVersion::v2, name, origin);
    case ExportTarget::fmu3:
      return fmu(rig, FmiVersion::v3, name, origin);
    case ExportTarget::c:
      return c_code(rig, name, origin);
    case ExportTarget::mjcf:
      return mjcf(rig, name, origin);
    case ExportTarget::urdf:
      return urdf(rig, name, origin);
    case ExportTarget::matlab:
      return matlab(rig, name, origin);
    case ExportTarget::frc:
      return frc(rig, name, origin);
  }
  throw std::logic_error("no such target");
}

}  // namespace axisfit
