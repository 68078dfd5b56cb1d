// Bad input, case by case of testdata/bad/cases.yaml, as files.
#pragma once

#include <yaml-cpp/yaml.h>

#include <map>
#include <string>
#include <vector>

namespace axisfit {

using InputFiles = std::map<std::string, std::string>;  ///< contents by name

class BadCases {
 public:
  explicit BadCases(const std::string& path);

  const InputFiles& good() const { return good_; }
  /// The cases of a family, and the families.
  YAML::Node family(const std::string& name) const { return cases_[name]; }
  std::vector<std::string> families() const;
  /// The files of a case: the good ones, changed.
  InputFiles files_of(const YAML::Node& node) const;

 private:
  YAML::Node cases_;
  InputFiles good_;
};

}  // namespace axisfit
