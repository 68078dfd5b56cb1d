// convergence JOB.yaml [STARTS]: from how many poor starts a fit reaches the minimum, and how long
// one fit takes on one core. Starts are drawn log-uniformly within the job's spread (5 unless it
// says otherwise) around the values in the axis file, which for simulated recordings are the truth.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "fit/estimate/estimate.h"
#include "io/config/job_file.h"
#include "report/text/names.h"

int main(int argc, char** argv) {
  using namespace axisfit;
  if (argc < 2 || argc > 3) {
    fmt::print(stderr, "usage: convergence JOB.yaml [STARTS]\n");
    return 2;
  }
  Job job = read_job_file(argv[1]).job;
  const int starts = argc > 2 ? std::max(1, std::atoi(argv[2])) : 100;
  std::vector<double> truth;
  for (FreeParameter& p : job.free) {
    p.initial = *members(job.model)[p.quantity];
    p.lower = std::min(p.lower, p.initial / 100.0);
    p.upper = std::max(p.upper, p.initial * 100.0);
    truth.push_back(p.initial);
  }
  std::vector<double> seconds;
  std::vector<double> worst(job.free.size(), 0.0);
  int reached = 0;
  for (int start = 1; start <= starts; ++start) {
    Job one = job;
    const std::vector<double> from = draw_start(job, start);
    for (std::size_t i = 0; i < from.size(); ++i) one.free[i].initial = from[i];
    const std::clock_t begin = std::clock();  // of this process: other loads do not count
    const FitResult result = estimate(one);
    seconds.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    if (result.is_usable() && result.reduced_chi_square < 1.1) {
      ++reached;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const double error = result.parameters[i].uncertainty.standard_error;
        worst[i] = std::max(worst[i], std::abs(result.parameters[i].value - truth[i]) / error);
      }
    } else {
      fmt::print("start {}: reduced chi-square {:.4g} after {:.2f} s; from", start,
                 result.reduced_chi_square, seconds.back());
      for (std::size_t i = 0; i < from.size(); ++i)
        fmt::print(" {}={:.3g}", name_of(job, job.free[i]), from[i]);
      fmt::print("\n");
    }
  }
  std::ranges::sort(seconds);
  fmt::print("{} of {} starts reach reduced chi-square < 1.1\n", reached, starts);
  fmt::print("processor time of one fit: median {:.2f} s, longest {:.2f} s\n",
             seconds[seconds.size() / 2], seconds.back());
  for (std::size_t i = 0; i < truth.size(); ++i)
    fmt::print("{}: at most {:.1f} standard errors from the value in the axis file\n",
               name_of(job, job.free[i]), worst[i]);
  return 0;
}
