#include "io/config/reference.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "tests/apps/files.h"

namespace axisfit {
namespace {

std::string contents_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(Reference, FilesMadeOfTheDescriptionsOfKeysAreUpToDate) {
  const auto files = reference_files(AXISFIT_PROJECT);
  EXPECT_EQ(files.size(), 10u);
  for (const auto& [name, contents] : files)
    EXPECT_TRUE(contents_of(std::string(AXISFIT_PROJECT) + "/" + name) == contents)
        << name << " is not what the descriptions of keys make: run scripts/update-reference";
}

TEST(Reference, APageKeepsItsTextAndShowsTablesThatThereAre) {
  const TempFolder project;
  std::filesystem::create_directory(project.path("docs"));
  for (const char* page : {"docs/job-file.md", "docs/axis-file.md", "docs/motion-file.md",
                           "docs/machine-file.md", "docs/fleet.md"})
    project.write(page, contents_of(std::string(AXISFIT_PROJECT) + "/" + page));
  const auto message = [&] {
    try {
      reference_files(project.path());
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string page = project.read("docs/motion-file.md");
  const std::size_t table = page.find("| `level` |");
  project.write("docs/motion-file.md",
                std::string(page).replace(table, 9, "| `lvl` |") + "The end.\n");
  EXPECT_EQ(reference_files(project.path()).at("docs/motion-file.md"), page + "The end.\n");

  project.write("docs/motion-file.md", replaced(page, "keys: motion.step", "keys: motion.stop"));
  EXPECT_EQ(message(), "docs/motion-file.md: there is no table 'motion.stop'");
  project.write("docs/motion-file.md", page.substr(0, table));
  EXPECT_EQ(message(), "docs/motion-file.md: a table of keys has no end");
  project.write("docs/motion-file.md", "# Motion file\n");
  EXPECT_EQ(message(), "no page in docs/ shows the table 'motion'");
}

}  // namespace
}  // namespace axisfit
