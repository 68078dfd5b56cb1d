// The axis of an FMU as a text, which its library reads from the resources.
#pragma once

#include <istream>
#include <string>

#include "sim/model.h"

namespace axisfit {

/// A model without controller, to the digit.
std::string axis_text(const Model<double>& model);

/// Throws std::runtime_error for anything else.
Model<double> read_axis_text(std::istream& in);

}  // namespace axisfit
