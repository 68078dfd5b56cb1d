// simulate-fleet FOLDER: a factory whose axes wear, to try axisfit-fleet on.

#include <fmt/format.h>

#include <algorithm>

#include "apps/command_line.h"
#include "base/parallel.h"
#include "fleet/factory.h"

namespace {

constexpr const char* kShortHelp = R"(Usage: simulate-fleet FOLDER

Example:
  simulate-fleet factory --axes 20 --nights 30

All options: simulate-fleet --help
)";

}  // namespace

int main(int argc, char** argv) {
  using namespace axisfit;
  std::string folder;
  FactoryOptions options;
  int threads = 0;
  CLI::App app{
      "Simulates a factory: axes that make the same motion every night, some of which wear, "
      "with nights missing and files damaged. truth.csv says what happened to which.",
      "simulate-fleet"};
  app.add_option("FOLDER", folder, "new folder")->required()->check(kNotEmpty);
  app.add_option("--axes", options.axes, "number of axes")
      ->capture_default_str()
      ->check(whole_number<std::size_t>(1, 9999));
  app.add_option("--nights", options.nights, "number of nights")
      ->capture_default_str()
      ->check(whole_number<std::size_t>(1, 10'000));
  app.add_option("--seed", options.seed, "seed of all that is drawn")
      ->capture_default_str()
      ->check(whole_number<std::uint64_t>(0));
  app.add_option("--worn", options.worn, "share of the axes that wear")
      ->capture_default_str()
      ->check(number(0, 1));
  app.add_option("--missing", options.missing, "share of nights without a recording")
      ->capture_default_str()
      ->check(number(0, 1));
  app.add_option("--wrong", options.wrong, "share of damaged recordings")
      ->capture_default_str()
      ->check(number(0, 1));
  app.add_option("--threads", threads, "0: as many as there are processors")
      ->capture_default_str()
      ->check(whole_number(0, 1024));
  return run_program(app, kShortHelp, argc, argv, [&] {
    const ThreadPool pool(threads);
    const std::vector<AxisTruth> truths = write_factory(folder, options);
    const auto worn =
        std::ranges::count_if(truths, [](const AxisTruth& t) { return t.wear != Wear::none; });
    print(fmt::format("{} axes over {} nights in {}; {} of them wear (truth.csv).\n", options.axes,
                      options.nights, folder, worn));
    return 0;
  });
}
