// Samples that copies share.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

namespace axisfit {

/// A vector of samples. Copies share it until one of them is edited: a search holds hundreds of
/// jobs with the same recordings. Reading is that of a constant vector, and safe from several
/// threads.
class Samples {
 public:
  using value_type = double;
  using const_iterator = std::vector<double>::const_iterator;
  using iterator = const_iterator;

  Samples() = default;
  // Both ways implicit: it is a vector, but for the copying.
  // NOLINTNEXTLINE(google-explicit-constructor)
  Samples(std::vector<double> values)
      : values_(std::make_shared<std::vector<double>>(std::move(values))) {}
  Samples(std::initializer_list<double> values) : Samples(std::vector<double>(values)) {}

  // NOLINTNEXTLINE(google-explicit-constructor)
  operator const std::vector<double>&() const { return *values_; }
  const_iterator begin() const { return values_->begin(); }
  const_iterator end() const { return values_->end(); }
  const double* data() const { return values_->data(); }
  std::size_t size() const { return values_->size(); }
  bool empty() const { return values_->empty(); }
  double operator[](std::size_t i) const { return (*values_)[i]; }
  double front() const { return values_->front(); }
  double back() const { return values_->back(); }

  /// The samples of this object alone, to be changed.
  std::vector<double>& edit() {
    if (values_.use_count() > 1) values_ = std::make_shared<std::vector<double>>(*values_);
    return *values_;
  }

  friend bool operator==(const Samples& a, const Samples& b) { return *a.values_ == *b.values_; }

 private:
  std::shared_ptr<std::vector<double>> values_ = std::make_shared<std::vector<double>>();
};

}  // namespace axisfit
