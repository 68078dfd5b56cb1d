// Counts allocations of the program that it is linked into.
#pragma once

namespace axisfit {

/// Calls of operator new so far.
long allocations();

}  // namespace axisfit
