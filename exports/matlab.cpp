#include <fmt/format.h>
#include <fmt/ranges.h>
#include <matio.h>

#include <array>
#include <cctype>
#include <cmath>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "exports/scratch_file.h"
#include "exports/targets.h"
#include "io/config/axis_file.h"

namespace axisfit {
namespace {

/// Covariance of the quantities that were fitted, in their units: of the estimates, and of a
/// further recording.
struct Covariance {
  std::vector<std::string> names;
  std::vector<double> values, of_estimates, of_machine;  ///< the latter by rows
};

Covariance covariance_of(const Rig& rig) {
  Covariance found;
  if (!rig.uncertainty) return found;
  Model<double> model = rig.model;
  const std::vector<double*> values = members(model);
  const std::vector<QuantityEntry>& list = quantity_list(vocabulary_of(rig.model.structure));
  const std::vector<UncertainQuantity>& quantities = rig.uncertainty->quantities;
  const std::size_t n = quantities.size();
  for (const UncertainQuantity& q : quantities) {
    found.names.push_back(list[q.quantity].name);
    found.values.push_back(*values[q.quantity]);
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const auto scale = [&](std::size_t k) {
        return quantities[k].logarithmic ? found.values[k] : 1.0;
      };
      const double c = rig.uncertainty->correlation[i * n + j] * quantities[i].error * scale(i) *
                       quantities[j].error * scale(j);
      const double own = i == j ? std::pow(quantities[i].scatter * scale(i), 2) : 0.0;
      found.of_estimates.push_back(c);
      found.of_machine.push_back(c + own);
    }
  return found;
}

std::string matlab_matrix(const std::vector<double>& values, std::size_t n) {
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < n; ++i)
    rows.push_back(fmt::format(
        "{}", fmt::join(values.begin() + static_cast<std::ptrdiff_t>(i * n),
                        values.begin() + static_cast<std::ptrdiff_t>((i + 1) * n), ", ")));
  return fmt::format("[{}]", fmt::join(rows, "; "));
}

/// A text in MATLAB's quotes.
std::string quoted(std::string text) {
  for (std::size_t at = 0; (at = text.find('\'', at)) != std::string::npos; at += 2)
    text.insert(at, 1, '\'');
  return "'" + text + "'";
}

std::string matlab_function(const Rig& rig, const std::string& name, const std::string& origin) {
  const Structure& structure = rig.model.structure;
  const Vocabulary vocabulary = vocabulary_of(structure);
  std::string text = fmt::format(
      "function axis = {0}()\n% {0}  Parameters of an axis, in SI units, and their covariance.\n",
      name);
  std::istringstream lines(origin);
  for (std::string line; std::getline(lines, line);) text += "% " + line + "\n";
  text += fmt::format(
      "axis.name = {};\naxis.drive = {};\naxis.transmission = {};\naxis.joint = {};\n",
      quoted(rig.name), quoted(drive_name(structure.drive, structure.joint)),
      quoted(transmission_name(structure.transmission)), quoted(joint_name(structure.joint)));
  Model<double> model = rig.model;
  const std::vector<double*> values = members(model);
  for (const QuantityEntry& entry : quantity_list(vocabulary)) {
    const bool own = entry.group.empty() || entry.effect;
    if (!own || !is_used(entry, structure)) continue;
    text +=
        fmt::format("axis.{}{} = {};  % {}: {}\n", entry.effect ? "effects." : "parameters.",
                    entry.name, *values[entry.index], entry.quantity.unit, entry.quantity.meaning);
  }
  const Covariance known = covariance_of(rig);
  std::vector<std::string> names;
  for (const std::string& n : known.names) names.push_back(quoted(n));
  text += fmt::format("axis.fitted.names = {{{}}};\naxis.fitted.values = [{}];\n",
                      fmt::join(names, ", "), fmt::join(known.values, ", "));
  text += "% of the estimates, and of a further recording, scatter included\n";
  text +=
      fmt::format("axis.fitted.covariance = {};\naxis.fitted.covariance_of_machine = {};\nend\n",
                  matlab_matrix(known.of_estimates, names.size()),
                  matlab_matrix(known.of_machine, names.size()));
  return text;
}

/// What a MAT-file holds of the covariance. The library writes to files only.
std::string mat_file(const Rig& rig) {
  const ScratchFile scratch;
  const std::string path = scratch.path();
  Covariance known = covariance_of(rig);  // the library takes what it only reads as if it wrote
  const std::size_t n = known.names.size();
  {
    const std::unique_ptr<mat_t, decltype(&Mat_Close)> file(
        Mat_CreateVer(path.c_str(), "MATLAB 5.0 MAT-file, by axisfit", MAT_FT_MAT5), &Mat_Close);
    if (!file) throw std::runtime_error("the MAT-file cannot be written");
    const auto write = [&](matvar_t* variable) {
      const std::unique_ptr<matvar_t, decltype(&Mat_VarFree)> owned(variable, &Mat_VarFree);
      if (!owned || Mat_VarWrite(file.get(), owned.get(), MAT_COMPRESSION_NONE) != 0)
        throw std::runtime_error("the MAT-file cannot be written");
    };
    const auto matrix = [&](const char* name, std::vector<double> values, std::size_t columns) {
      // Columns first, which makes no difference to symmetric ones.
      std::array<std::size_t, 2> size{values.size() / std::max<std::size_t>(1, columns), columns};
      write(Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0));
    };
    std::array<std::size_t, 2> size{n, 1};
    matvar_t* names = Mat_VarCreate("names", MAT_C_CELL, MAT_T_CELL, 2, size.data(), nullptr, 0);
    for (std::size_t i = 0; i < n; ++i) {
      std::array<std::size_t, 2> length{1, known.names[i].size()};
      Mat_VarSetCell(names, static_cast<int>(i),
                     Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UINT8, 2, length.data(),
                                   known.names[i].data(), 0));
    }
    write(names);
    matrix("values", known.values, 1);
    matrix("covariance", known.of_estimates, n);
    matrix("covariance_of_machine", known.of_machine, n);
  }
  return scratch.read();
}

}  // namespace

Export matlab(const Rig& rig, const std::string& of_file, const std::string& origin) {
  const std::string name = identifier(of_file);
  return {
      {{name + ".m", matlab_function(rig, name, origin)}, {name + ".mat", mat_file(rig)}}, rig, {}};
}

}  // namespace axisfit
