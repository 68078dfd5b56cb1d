// The readings of the instruments at the samples of a recording, with their lags and delays.
//
// Neither acts on the axis, so both are applied to the readings afterwards. An instrument with a
// lag or delay is therefore read at more instants than the samples: every interval is divided, and
// the reading is taken as linear in between. The lag's response to that is exact, and regular at a
// lag of zero.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "sim/integrator.h"

namespace axisfit {

template <class T>
class Recorder {
 public:
  /// For these signals at these sample times (s, increasing). The instruments and signals must
  /// outlive it.
  Recorder(const Instruments<T>& instruments, std::span<const Signal> signals,
           std::span<const double> times)
      : instruments_(instruments), signals_(signals), raw_(signals.size()) {
    for (const Signal signal : signals)
      if (has_lag_or_delay(signal)) substeps_ = 4;
    instants_ = refined(times);
    for (auto& values : raw_) values.reserve(instants_.size());
  }

  /// When the simulation has to be read.
  const std::vector<double>& instants() const { return instants_; }
  /// A series of values at the samples, at the instants: linear between samples.
  std::vector<double> refined(std::span<const double> series) const {
    std::vector<double> fine;
    if (series.empty()) return fine;
    fine.reserve((series.size() - 1) * substeps_ + 1);
    for (std::size_t i = 0; i + 1 < series.size(); ++i)
      for (std::size_t k = 0; k < substeps_; ++k)
        fine.push_back(series[i] + double(k) / double(substeps_) * (series[i + 1] - series[i]));
    fine.push_back(series.back());
    return fine;
  }
  /// Whether an instant is a sample.
  bool is_sample(std::size_t instant) const { return instant % substeps_ == 0; }
  /// The instant of a sample.
  std::size_t instant_of(std::size_t sample) const { return sample * substeps_; }

  /// To be called at every instant.
  void read(const Integrator<T>& axis) {
    for (std::size_t s = 0; s < signals_.size(); ++s)
      note(s, reading(axis.equations(), signals_[s], axis.mode(), axis.state(), axis.input()));
  }
  /// Instead, for each signal: what an instrument without lag or delay shows.
  void note(std::size_t s, const T& shown) { raw_[s].push_back(shown); }

  /// What the instrument for signals[s] shows at the samples that were reached.
  /// In the signal's unit, one value per sample. To be called once: it takes what was read.
  std::vector<T> readings(std::size_t s) {
    const Instrument<T>& instrument = instruments_[index_of(signals_[s])];
    std::vector<T> fine = std::move(raw_[s]);
    if (is_active(instrument.lag)) fine = lagging(fine, instrument.lag);
    const bool delayed = is_active(instrument.delay) || is_active(instrument.drift);
    if (substeps_ == 1 && !delayed) return fine;
    std::vector<T> shown;
    shown.reserve(fine.size() / substeps_ + 1);
    for (std::size_t k = 0; k < fine.size(); k += substeps_)
      shown.push_back(delayed ? at(fine, k, delay_at(k, instrument)) : fine[k]);
    return shown;
  }

 private:
  bool has_lag_or_delay(Signal signal) const {
    const Instrument<T>& instrument = instruments_[index_of(signal)];
    return is_active(instrument.lag) || is_active(instrument.delay) || is_active(instrument.drift);
  }
  T delay_at(std::size_t instant, const Instrument<T>& instrument) const {
    return instrument.delay + instrument.drift * (instants_[instant] - instants_.front());
  }

  /// lag s' = u - s with u linear between the instants and s = u at the first.
  std::vector<T> lagging(const std::vector<T>& u, const T& lag) const {
    using std::exp;
    std::vector<T> s = u;
    for (std::size_t k = 1; k < u.size(); ++k) {
      const double h = instants_[k] - instants_[k - 1];
      const T behind = lag * (u[k] - u[k - 1]) / h;
      s[k] = u[k] - behind;
      if (value_of(lag) > h / 700.0) s[k] += (s[k - 1] - u[k - 1] + behind) * exp(-h / lag);
    }
    return s;
  }

  /// Value `delay` before instant i, linear between instants; the first and the last hold on.
  T at(const std::vector<T>& u, std::size_t i, const T& delay) const {
    const T t = instants_[i] - delay;
    if (t <= instants_.front()) return u.front();
    const auto after = std::ranges::lower_bound(instants_, value_of(t));
    const auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, after - instants_.begin()));
    if (k >= u.size()) return u.back();
    const T share = (t - instants_[k - 1]) / (instants_[k] - instants_[k - 1]);
    return u[k - 1] + share * (u[k] - u[k - 1]);
  }

  const Instruments<T>& instruments_;
  std::span<const Signal> signals_;
  std::size_t substeps_ = 1;
  std::vector<double> instants_;
  std::vector<std::vector<T>> raw_;
};

}  // namespace axisfit
