#include "base/convolution.h"

#include <algorithm>
#include <bit>
#include <complex>
#include <unsupported/Eigen/FFT>

namespace axisfit {
namespace {

using Spectrum = std::vector<std::complex<double>>;

/// Transforms of real sequences with zeros behind them, so that nothing wraps around.
class Transform {
 public:
  explicit Transform(std::size_t length) : buffer_(std::bit_ceil(length)) {
    fft_.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  }
  Spectrum forward(std::span<const double> values) {
    std::ranges::fill(std::ranges::copy(values, buffer_.begin()).out, buffer_.end(), 0.0);
    Spectrum spectrum;
    fft_.fwd(spectrum, buffer_);
    return spectrum;
  }
  const std::vector<double>& backward(const Spectrum& spectrum) {
    fft_.inv(buffer_, spectrum, static_cast<Eigen::Index>(buffer_.size()));
    return buffer_;
  }

 private:
  Eigen::FFT<double> fft_;
  std::vector<double> buffer_;
};

}  // namespace

std::vector<double> lagged_products(std::span<const double> values) {
  Transform transform(2 * values.size());
  Spectrum spectrum = transform.forward(values);
  for (std::complex<double>& x : spectrum) x = std::norm(x);
  std::vector<double> products = transform.backward(spectrum);
  products.resize(values.size());
  return products;
}

Eigen::MatrixXd toeplitz_product(std::span<const double> kernel, const Eigen::MatrixXd& columns) {
  const auto n = static_cast<std::size_t>(columns.rows());
  Transform transform(n + kernel.size());
  Spectrum response = transform.forward(kernel);
  // The kernel at negative lags is its mirror image: the transform of both is real.
  for (std::complex<double>& x : response) x = 2.0 * x.real() - kernel[0];
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    Spectrum spectrum = transform.forward({columns.col(c).data(), n});
    for (std::size_t k = 0; k < spectrum.size(); ++k) spectrum[k] *= response[k];
    const std::vector<double>& product = transform.backward(spectrum);
    result.col(c) = Eigen::VectorXd::Map(product.data(), columns.rows());
  }
  return result;
}

}  // namespace axisfit
