// The distributions that tests and intervals need. Boost.Math behind a few functions: its headers
// take seconds to compile, and are compiled once.
#pragma once

namespace axisfit {

/// The value below which a standard normal variable stays with this probability.
double normal_quantile(double probability);
double normal_density(double x);
/// The probability that it stays below x.
double normal_cdf(double x);

/// The value that Student's t exceeds with this probability, and the probability that it exceeds x.
double student_upper_quantile(double probability, double degrees_of_freedom);
double student_upper_tail(double x, double degrees_of_freedom);
/// The value below which Student's t stays with this probability.
double student_quantile(double probability, double degrees_of_freedom);

/// The value that chi-square exceeds with this probability.
double chi_square_upper_quantile(double probability, double degrees_of_freedom);

/// The probability that Fisher's F with these degrees of freedom exceeds x.
double fisher_upper_tail(double x, double numerator, double denominator);

}  // namespace axisfit
