// evaluation [OPTIONS OF GOOGLE BENCHMARK]: the time of one residual with its Jacobian over the
// number of parameters, the duration and the observer; the multiply-adds that the exact method
// needs for it; how many of them this machine does, at most, compiled as axisfit is; and the speed
// of reading a CSV file of a million rows, beside that of reading its bytes.
#include "bench/speed/evaluation.h"

#include <benchmark/benchmark.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "io/recording/csv.h"

namespace {

using namespace axisfit;
using namespace axisfit::speed;

/// Multiply-adds of products with a matrix, given by columns, of which a dual number needs one for
/// the value and per parameter one for the vector's derivative and one for the matrix's own, where
/// it has any.
template <int N>
double multiply_adds(std::span<const State<Jet<N>>> columns) {
  double count = 0.0;
  for (const State<Jet<N>>& column : columns)
    for (const Jet<N>& x : column) {
      if (!is_active(x)) continue;
      count += 1.0 + N;
      for (int k = 0; k < N; ++k) count += x.v[k] != 0.0;
    }
  return count;
}

/// Of a sample of the paper's step: f = A y + B w and y + Psi f, in the mode in which it rests at
/// the end, teeth in contact and no limit reached. The reading of y1' is an element of f.
template <int N>
double multiply_adds_of_sample() {
  const Work work{x_axis(), Work{}.command, {}};
  const Model<Jet<N>> model = work.model<N>();
  const Equations<Jet<N>> equations(model);
  Mode mode;
  mode.contact = mode.sliding = 1;
  const Matrix<Jet<N>> a = system_matrix(equations, mode);
  Propagator<Jet<N>> propagator(a, step_levels_for(a, 1e-3, 0));
  std::array<State<Jet<N>>, kStates> columns_of_a, columns_of_psi;
  for (std::size_t j = 0; j < kStates; ++j) {
    State<Jet<N>> unit{};
    unit[j] = Jet<N>(1.0);
    columns_of_a[j] = propagator.a_times(unit);
    columns_of_psi[j] = propagator.advance(State<Jet<N>>{}, unit, {}, 0);
    // Beyond the paper's states it is the identity, times the step.
    if (j >= kPaperStates) columns_of_psi[j] = {};
  }
  const PerInput<State<Jet<N>>> b = input_matrix(equations, mode);
  return multiply_adds<N>(columns_of_a) + multiply_adds<N>(columns_of_psi) + multiply_adds<N>(b);
}

template <int N>
void residual_and_jacobian(benchmark::State& state) {
  const double duration = 1e-3 * static_cast<double>(state.range(0));
  Evaluation evaluation(x_axis(), N, duration, static_cast<double>(state.range(1)));
  for (auto _ : state)
    if (!evaluation.run()) state.SkipWithError("does not finish");
  const double needed = static_cast<double>(state.range(0)) * multiply_adds_of_sample<N>();
  using benchmark::Counter;
  state.counters["needed"] = Counter(needed, Counter::kDefaults);
  state.counters["needed/s"] = Counter(needed, Counter::kIsIterationInvariantRate);
}

/// Multiply-adds of this machine's widest registers that need no run-time dispatch, in so many
/// chains that none waits for another.
void peak(benchmark::State& state) {
  constexpr std::size_t kChains = 12, kRounds = 1000;
  using Pair = double __attribute__((vector_size(16)));
  std::array<Pair, kChains> sums{};
  Pair factor{1.0 + 1e-9, 1.0 - 1e-9}, term{1e-9, -1e-9};
  benchmark::DoNotOptimize(factor);
  benchmark::DoNotOptimize(term);
  for (auto _ : state) {
    for (std::size_t i = 0; i < kRounds; ++i)
      for (Pair& sum : sums) sum = sum * factor + term;
    benchmark::DoNotOptimize(sums);
  }
  using benchmark::Counter;
  state.counters["done/s"] = Counter(2.0 * kChains * kRounds, Counter::kIsIterationInvariantRate);
}

/// A recording of the x axis, a million samples of the velocity.
class LongFile {
 public:
  LongFile() : path_(std::filesystem::temp_directory_path() / "axisfit-evaluation.csv") {
    RecordingOptions options;
    options.duration = 1000.0;
    options.signals = {Signal::velocity};
    std::ofstream out(path_, std::ios::binary);
    write_csv(out, record(x_axis(), PrbsMotion{2.0, 0.2}, options), 9);
  }
  ~LongFile() { std::filesystem::remove(path_); }
  LongFile(const LongFile&) = delete;
  LongFile& operator=(const LongFile&) = delete;

  std::string path() const { return path_.string(); }
  /// Bytes that so many readings take.
  std::int64_t bytes(std::int64_t readings) const {
    return readings * static_cast<std::int64_t>(std::filesystem::file_size(path_));
  }

 private:
  std::filesystem::path path_;
};

void reading_csv(benchmark::State& state) {
  const LongFile file;
  for (auto _ : state) benchmark::DoNotOptimize(read_csv(file.path()));
  state.SetBytesProcessed(file.bytes(state.iterations()));
}

void reading_bytes(benchmark::State& state) {
  const LongFile file;
  std::vector<char> part(1 << 16);
  for (auto _ : state) {
    std::ifstream in(file.path(), std::ios::binary);
    while (in) in.read(part.data(), static_cast<std::streamsize>(part.size()));
    benchmark::DoNotOptimize(part);
  }
  state.SetBytesProcessed(file.bytes(state.iterations()));
}

// Duration in ms, observer in 1/s.
BENCHMARK(residual_and_jacobian<1>)->Args({2500, 0})->Unit(benchmark::kMillisecond);
BENCHMARK(residual_and_jacobian<5>)
    ->Args({2500, 0})
    ->Args({5000, 0})
    ->Args({10000, 0})
    ->Args({20000, 0})
    ->Args({2500, 1000})
    ->Args({2500, 30})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(residual_and_jacobian<10>)->Args({2500, 0})->Unit(benchmark::kMillisecond);
BENCHMARK(residual_and_jacobian<20>)->Args({2500, 0})->Unit(benchmark::kMillisecond);
BENCHMARK(peak);
BENCHMARK(reading_csv)->Unit(benchmark::kMillisecond);
BENCHMARK(reading_bytes)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
