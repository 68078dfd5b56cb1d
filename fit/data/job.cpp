#include "fit/data/job.h"

#include <algorithm>
#include <stdexcept>

namespace axisfit {

FreeParameter free_parameter(std::string_view name, double initial) {
  const QuantityEntry* entry = find_quantity(name);
  if (entry == nullptr) throw std::invalid_argument("unknown quantity '" + std::string(name) + "'");
  const Quantity& q = entry->quantity;
  FreeParameter p;
  p.quantity = entry->index;
  p.initial = initial;
  p.logarithmic = initial > 0.0;
  p.lower = p.logarithmic ? std::max(q.lower, initial / 100.0) : q.lower;
  p.upper = p.logarithmic ? std::min(q.upper, initial * 100.0) : q.upper;
  return p;
}

}  // namespace axisfit
