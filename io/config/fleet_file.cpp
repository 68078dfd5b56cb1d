#include "io/config/fleet_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "base/plain_text.h"
#include "io/config/config.h"

namespace axisfit {

namespace fs = std::filesystem;

const Section& fleet_keys() {
  static const Section keys{
      Key::required(
          "job", Text{},
          "job file that every axis is fitted by on every night; `{axis}` and `{night}` in "
          "it stand for their names"),
      Key::optional(
          "items", Text{}, DefaultText{"those of `manifest`"},
          "files of the axes and nights, such as `recordings/{axis}/{night}.csv`: one for "
          "each"),
      Key::optional(
          "manifest", Text{}, DefaultText{"the files of `items`"},
          "list of the axes and nights: text with commas, or the table `items` of an SQLite "
          "database (`.sqlite`, `.db`), with the columns `axis`, `night` and any other name "
          "that the job has in braces"),
      Key::optional("history", Text{}, DefaultText{"`history.sqlite`"},
                    "database of the results of all nights"),
      Key::optional("close_loop",
                    Choice{{{"never", ""},
                            {"unexplained", "on nights whose fit leaves more than noise"},
                            {"always", ""}}},
                    FleetFile().close_loop, "when effects that the model lacks are searched for"),
      Key::optional("one_in", Integer{10, 1'000'000'000}, FleetFile().one_in,
                    "axis-nights in which one false alarm is allowed"),
      Key::optional("limits", Map{{}, 1, false, {}, {{"[A-Za-z_][A-Za-z0-9_.]*", Text{}}}},
                    DefaultText{"none"}, "by parameter, what it must not reach: `B_a: 300 N s/m`")};
  return keys;
}

FleetFile read_fleet_file(const std::string& path) {
  Diagnostics diagnostics;
  FleetFile file;
  file.path = path;
  if (const auto root = ConfigNode::load(path, diagnostics)) {
    ConfigMap map(*root, fleet_keys());
    const fs::path folder = (fs::current_path() / root->directory()).lexically_normal();
    const auto absolute = [&](const std::string& name) {
      return name.empty() ? name : (folder / name).lexically_normal().string();
    };
    std::string job;
    const auto job_node = map.read("job", job);
    const auto items = map.read("items", file.items);
    const auto manifest = map.read("manifest", file.manifest);
    file.history = "history.sqlite";
    map.read("history", file.history);
    map.read("close_loop", file.close_loop);
    map.read("one_in", file.one_in);
    if (const auto limits = map.given("limits"); limits && limits->is_map())
      for (ConfigMap entries(*limits); const auto& [key, value] : entries.entries()) {
        std::istringstream text(value.text());
        double amount = 0.0;
        std::string unit;
        if (!(text >> amount)) {
          value.error("a limit is a number with its unit, such as 300 N s/m");
          continue;
        }
        std::getline(text >> std::ws, unit);
        file.limits[key.text()] = {amount, unit.empty() ? "1" : unit};
      }
    map.finish();
    if (items && manifest) manifest->error("give either 'items' or 'manifest'");
    if (!items && !manifest)
      root->error("the axes and nights are missing: give 'items' or 'manifest'");
    if (items)
      for (const char* name : {"{axis}", "{night}"})
        if (file.items.find(name) == std::string::npos)
          items->error(fmt::format("the pattern has no {}", name));
    file.items = absolute(file.items);
    file.manifest = absolute(file.manifest);
    file.history = absolute(file.history);
    const fs::path job_path = absolute(job);
    file.folder = job_path.parent_path().string();
    file.job_name = job_path.filename().string();
    if (job_node) {
      std::ifstream in(job_path, std::ios::binary);
      if (in)
        file.job_text.assign(std::istreambuf_iterator<char>(in), {});
      else
        job_node->error(fmt::format("{} cannot be read", in_quotes(job_path.string())));
    }
  }
  diagnostics.throw_if_any();
  return file;
}

}  // namespace axisfit
