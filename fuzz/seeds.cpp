// fuzz_seeds PROJECT FOLDER: writes inputs to begin with, FOLDER/TARGET/NAME, made of the cases of
// testdata/bad, the shipped configurations and the beginnings of the shipped recordings; and
// FOLDER/words.dict, the words of the configuration files.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include "io/config/axis_file.h"
#include "io/config/job_file.h"
#include "io/config/motion_file.h"
#include "tests/apps/bad_cases.h"

namespace axisfit {
namespace {

namespace fs = std::filesystem;

std::string contents_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Small files: what makes a file large makes fuzzing slow.
class Seeds {
 public:
  explicit Seeds(fs::path folder) : folder_(std::move(folder)) {}

  void add(const std::string& target, const std::string& contents) {
    constexpr std::size_t kLargest = 10'000;
    if (contents.size() > kLargest || !known_.insert(target + contents).second) return;
    fs::create_directories(folder_ / target);
    std::ofstream(folder_ / target / ("seed-" + std::to_string(++count_)), std::ios::binary)
        << contents;
  }

  std::size_t count() const { return count_; }

 private:
  fs::path folder_;
  std::set<std::string> known_;
  std::size_t count_ = 0;
};

/// As check.h takes them apart.
std::string together(const InputFiles& files) {
  std::string text;
  for (const auto& [name, contents] : files)
    text += "=== " + name + "\n" + contents + (contents.ends_with('\n') ? "" : "\n");
  return text;
}

void add_cases(Seeds& seeds, const BadCases& cases) {
  for (const std::string& family : cases.families())
    for (const YAML::Node& node : cases.family(family)) {
      const InputFiles files = cases.files_of(node);
      for (const auto& [name, contents] : files) {
        if (name.ends_with(".csv")) {
          seeds.add("csv", contents);
          seeds.add("init", contents);
        }
        if (name.ends_with(".mat")) seeds.add("mat", contents);
        if (name == "axis.yaml") seeds.add("axis", together({{name, contents}}));
      }
      seeds.add("job", together(files));
    }
}

void add_configs(Seeds& seeds, const fs::path& project) {
  const fs::path configs = project / "configs";
  for (const auto& axis : fs::directory_iterator(configs / "axes"))
    for (const auto& motion : fs::directory_iterator(configs / "motions"))
      seeds.add("axis",
                together({{"axis.yaml", contents_of(axis)}, {"motion.yaml", contents_of(motion)}}));
  InputFiles recordings;
  for (const auto& entry : fs::recursive_directory_iterator(project / "testdata")) {
    for (const char* format : {"mcap", "xlsx"})
      if (entry.path().extension() == std::string(".") + format)
        seeds.add(format, contents_of(entry));
    if (entry.path().extension() != ".csv") continue;
    constexpr int kLines = 30;
    const std::string all = contents_of(entry);
    std::size_t end = 0;
    for (int i = 0; i < kLines; ++i) end = all.find('\n', end) + 1;
    recordings[entry.path().filename()] = all.substr(0, end);
    seeds.add("csv", all.substr(0, end));
    seeds.add("init", all.substr(0, end));
  }
  for (const auto& entry : fs::directory_iterator(configs / "jobs")) {
    // All files of a job in one folder.
    const std::string job =
        std::regex_replace(contents_of(entry), std::regex("(axis|file): [^\\s,}]*/"), "$1: ");
    InputFiles files{{"job.yaml", job}};
    for (const auto& axis : fs::directory_iterator(configs / "axes"))
      if (const std::string name = axis.path().filename(); job.find(name) != job.npos)
        files[name] = contents_of(axis);
    for (const auto& [name, contents] : recordings)
      if (job.find(name) != job.npos) files[name] = contents;
    seeds.add("job", together(files));
  }
}

/// The result target draws from any bytes; more of them make more of a job.
void add_draws(Seeds& seeds) {
  std::uint32_t state = 1;
  for (int length = 50; length <= 600; length += 50) {
    std::string bytes;
    for (int i = 0; i < length; ++i) {
      state = 1664525 * state + 1013904223;
      bytes += static_cast<char>(state >> 24);
    }
    seeds.add("result", bytes);
  }
}

/// Everything that the description of keys names: keys, choices and units.
class Words {
 public:
  explicit Words(const Section& keys) { add(keys); }

  void add(const Section& keys) {
    for (const Key& key : keys) {
      words_.insert(key.name + ": ");
      add(key.form);
    }
  }

  std::string dictionary() const {
    std::string text;
    for (const std::string& word : words_) text += '"' + word + "\"\n";
    return text;
  }

 private:
  void add(const Form& form) {
    if (const auto* amount = std::get_if<NumberWithUnit>(&form)) words_.insert(" " + amount->unit);
    if (const auto* bounds = std::get_if<Bounds>(&form)) add(bounds->of);
    if (const auto* choice = std::get_if<Choice>(&form))
      for (const std::string& name : choice->names()) words_.insert(name);
    if (const auto* map = std::get_if<Map>(&form)) add(map->keys);
    if (const auto* list = std::get_if<List>(&form)) add(list->of.front());
    if (const auto* either = std::get_if<AnyOf>(&form))
      for (const Form& one : either->forms) add(one);
  }

  std::set<std::string> words_;
};

}  // namespace
}  // namespace axisfit

int main(int argc, char** argv) {
  using namespace axisfit;
  if (argc != 3) return 2;
  const fs::path project = argv[1];
  Seeds seeds(argv[2]);
  add_cases(seeds, BadCases((project / "testdata/bad/cases.yaml").string()));
  add_configs(seeds, project);
  add_draws(seeds);
  Words words(job_keys());
  words.add(axis_keys(kSourceVocabulary));
  words.add(motion_keys());
  for (const std::string& type : std::get<Choice>(find_key(motion_keys(), "type").form).names())
    words.add(motion_keys(type, kSourceVocabulary));
  std::ofstream(fs::path(argv[2]) / "words.dict") << words.dictionary();
  std::cout << seeds.count() << " seeds\n";
}
