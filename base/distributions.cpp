#include "base/distributions.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

namespace axisfit {

using boost::math::complement;

double normal_quantile(double probability) { return quantile(boost::math::normal(), probability); }

double normal_density(double x) { return pdf(boost::math::normal(), x); }

double normal_cdf(double x) { return cdf(boost::math::normal(), x); }

double student_quantile(double probability, double degrees_of_freedom) {
  return quantile(boost::math::students_t(degrees_of_freedom), probability);
}

double student_upper_quantile(double probability, double degrees_of_freedom) {
  return quantile(complement(boost::math::students_t(degrees_of_freedom), probability));
}

double student_upper_tail(double x, double degrees_of_freedom) {
  return cdf(complement(boost::math::students_t(degrees_of_freedom), x));
}

double chi_square_upper_quantile(double probability, double degrees_of_freedom) {
  return quantile(complement(boost::math::chi_squared(degrees_of_freedom), probability));
}

double fisher_upper_tail(double x, double numerator, double denominator) {
  return cdf(complement(boost::math::fisher_f(numerator, denominator), x));
}

}  // namespace axisfit
