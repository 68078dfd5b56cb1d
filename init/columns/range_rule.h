// What nothing but the size of the values tells. All of it is a guess.
#pragma once

#include <vector>

#include "init/columns/column_set.h"

namespace axisfit {

/// A motion by how large its values are at most, as stored: whole numbers that are large are
/// counts, what is below ten is in m or rad (m/s, rad/s), the rest in mm or deg. A counter that
/// begins anew after a turn of whole steps is in turns.
void size_motion_by_range(UnscaledColumn& column, Joint joint, double range);

/// A duty: up to 1, 100, 255, 1023 or 4095 is the whole supply.
void size_duty_by_range(UnscaledColumn& column);

/// The time, by the interval between its samples.
void size_time_by_interval(UnscaledColumn& time);

/// A voltage that hardly changes drives nothing: it is that of the supply.
bool is_supply(Kind kind, const std::vector<double>& values);

}  // namespace axisfit
