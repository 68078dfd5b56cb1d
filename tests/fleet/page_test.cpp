#include "fleet/page.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

namespace axisfit {
namespace {

/// Three axes of five nights, of which the first has a name that would be markup.
std::vector<NightResult> nights() {
  std::vector<NightResult> all;
  for (const char* axis : {"<b>x</b>", "y", "z"})
    for (int i = 1; i <= 5; ++i) {
      NightResult night;
      night.axis = axis;
      night.night = std::to_string(i);
      night.status = "explained";
      night.parameters = {{"B_a", "N s/m", 10.0 + 0.1 * i, 0.1}, {"M", "kg", 5.0, 0.01}};
      night.residuals = {{"</script>", "position", "m", "fit", 1e-6, 1.0}};
      all.push_back(night);
    }
  return all;
}

FleetReport report() {
  FleetReport found;
  found.axes = 3;
  found.nights = 5;
  found.results = 15;
  found.alarms = {{Alarm::Kind::parameter, "<b>x</b>", "B_a", "4", "3", 10.0, 11.0, 7.0,
                   "B_a up 10 % since 3."}};
  return found;
}

TEST(FleetPage, HoldsWhatItShowsAndNoMarkupOfUsers) {
  const std::string page = fleet_page(nights(), report());
  if (const char* path = std::getenv("AXISFIT_FLEET_PAGE")) std::ofstream(path) << page;
  EXPECT_EQ(page.find("<b>x"), std::string::npos);
  const std::string begin = "id=\"data\">";
  const std::size_t at = page.find(begin) + begin.size();
  const auto data = nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
  EXPECT_EQ(data.at("axes").size(), 3u);
  EXPECT_EQ(data.at("axes")[0].at("name"), "<b>x</b>");
  EXPECT_EQ(data.at("axes")[0].at("state"), "parameter");
  EXPECT_EQ(data.at("axes")[1].at("state"), "");
  EXPECT_EQ(data.at("nights").size(), 5u);
  ASSERT_EQ(data.at("courses").size(), 3u);
  EXPECT_EQ(data.at("courses")[0].at("name"), "B_a");
  EXPECT_EQ(data.at("alarms")[0].at("at"), 3);
  EXPECT_EQ(data.at("alarms")[0].at("course"), 0);
  for (const char* id : {"values-0", "errors-0", "values-2"})
    EXPECT_NE(page.find("id=\"" + std::string(id) + "\">"), std::string::npos) << id;
}

}  // namespace
}  // namespace axisfit
