#include "apps/fit_arguments.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace axisfit {
namespace {

/// What fit-params makes of a command line.
FitArguments parsed(std::vector<std::string> words) {
  CLI::App app;
  FitArguments arguments;
  add_options(app, arguments);
  words.insert(words.begin(), "fit-params");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  app.parse(static_cast<int>(argv.size()), argv.data());
  complete(app, static_cast<int>(argv.size()), argv.data(), arguments);
  return arguments;
}

TEST(FitArguments, AreNoneButTheJob) {
  const FitArguments plain = parsed({"job.yaml"});
  EXPECT_EQ(plain.files, std::vector<std::string>{"job.yaml"});
  EXPECT_FALSE(plain.options.predict || plain.options.compare || plain.options.select_effects);
  EXPECT_TRUE(plain.profiled.empty());
  EXPECT_FALSE(plain.threads || plain.starts || plain.seed || plain.time_limit);
}

TEST(FitArguments, FlagsMayHaveNames) {
  EXPECT_EQ(parsed({"job.yaml", "--profile"}).profiled, std::vector<std::string>{"all"});
  EXPECT_EQ(parsed({"job.yaml", "--profile=M,B_a"}).profiled,
            (std::vector<std::string>{"M", "B_a"}));
  const FitArguments alone = parsed({"job.yaml", "--compare", "--predict"});
  EXPECT_TRUE(alone.options.compare && alone.options.predict);
  EXPECT_TRUE(alone.others.empty());
  EXPECT_EQ(alone.motion, "-");
  const FitArguments named = parsed({"job.yaml", "--compare=a.yaml,b.yaml", "--predict=m.yaml"});
  EXPECT_EQ(named.others, (std::vector<std::string>{"a.yaml", "b.yaml"}));
  EXPECT_EQ(named.motion, "m.yaml");
}

TEST(FitArguments, SomeExcludeOthers) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"job.yaml", "--check", "--close-loop"},
        {"job.yaml", "--json", "--quiet"},
        {"job.yaml", "--resume"},
        {"job.yaml", "--within", "1mm"},
        {"job.yaml", "--axis", "a.yaml"},
        {"job.yaml", "--rate", "1 kHz"},
        {"job.yaml", "--motor", "0"},
        {"job.yaml", "--threads", "0"},
        {"job.yaml", "--time-limit", "0"},
        {"a.csv", "--init", "--machine", "loom"}})
    EXPECT_THROW(parsed(words), CLI::ParseError) << words.back();
}

TEST(Quoted, IsWhatAShellReadsAsOneWord) {
  EXPECT_EQ(quoted("a/b-1.yaml"), "a/b-1.yaml");
  EXPECT_EQ(quoted(""), "''");
  EXPECT_EQ(quoted("a b"), "'a b'");
  EXPECT_EQ(quoted("it's"), "'it'\\''s'");
  EXPECT_EQ(quoted("$HOME"), "'$HOME'");
}

}  // namespace
}  // namespace axisfit
