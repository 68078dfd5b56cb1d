// The ratio of derivatives: a velocity is that of its position, an acceleration that of its
// velocity, so that each tells the unit of the other, its sign, and that of the time.
#pragma once

#include <vector>

#include "init/columns/column_set.h"

namespace axisfit {

/// The unit of the time, where a position and a velocity of known units tell it. Whether they do.
bool size_time_by_motion(UnscaledColumn& time, ColumnSet& columns);

/// Position and velocity by each other. One that the other does not tell stays as it is; a velocity
/// that does not follow the position is asked about.
void size_motion_by_derivative(const UnscaledColumn& time, ColumnSet& columns);

/// The acceleration by the velocity or, where there is none, the position. What they do not tell
/// stays as it is.
void size_acceleration_by_derivative(const UnscaledColumn& time, ColumnSet& columns);

/// The derivative of values, by the values to both sides.
std::vector<double> derivative_at(const std::vector<double>& times,
                                  const std::vector<double>& values);

}  // namespace axisfit
