#include "pliant/analysis/replay_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "pliant/tests/analysis/compliance_experiment.h"
#include "pliant/tests/support/temporary_directory.h"

namespace pliant {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsSupersetOf;

// A hand holds the elbow from 0.02 s on; the push acts at the tool from the start.
RunData Held() {
  const TemporaryDirectory out;
  const Overrides set = {
      {"environment",
       "[!Push {link: tool_frame, force: [0, 0, -20], start_s: 0, duration_s: 0.08, edge_s: 0.02}, "
       "!Hand {link: "
       "forearm_link, stiffness: [500, 500, 500], damping: 20, start_s: 0.02, duration_s: 0.03}]"}};
  const auto logs = RunExperiment(ExperimentFile::ReadText(std::string(kShort), "e.yaml", set),
                                  {.out = out.path()});
  return RunData::Read(logs.front());
}

/// The JSON in a script element of that id.
json ScriptOf(const std::string& html, const std::string& id) {
  const std::string tag = "id=\"" + id + "\">";
  const std::size_t begin = html.find(tag) + tag.size();
  return json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

TEST(ReplaySection, NamesTheColumnsThatSayWhereEachForceActs) {
  const RunData held = Held();
  const json page = ScriptOf(internal::ReplaySectionOf({&held}, 1'000'000).end, "runs");
  std::set<std::string> columns;
  for (const json& column : page["runs"][0]["columns"]) columns.insert(column["name"]);

  std::vector<std::string> names;
  for (const json& force : page["runs"][0]["forces"]) {
    names.push_back(force["name"]);
    EXPECT_TRUE(columns.contains(force["link"])) << force;
    for (const char* vector : {"point", "force"}) {
      ASSERT_EQ(force[vector].size(), 3u) << force;
      for (const json& column : force[vector]) EXPECT_TRUE(columns.contains(column)) << column;
    }
  }
  EXPECT_THAT(names, IsSupersetOf({"push_1.force", "hand_1.contact"}));
  const json& push =
      page["runs"][0]["forces"]
          [static_cast<std::size_t>(std::ranges::find(names, "push_1.force") - names.begin())];
  EXPECT_EQ(push["link"], "push_1.force.link");
  EXPECT_THAT(push["force"], ElementsAre("push_1.force.force[x]", "push_1.force.force[y]",
                                         "push_1.force.force[z]"));
}

TEST(ReplaySection, NamesTheLinksInTheOrderOfTheirIndex) {
  const RunData held = Held();
  const json page = ScriptOf(internal::ReplaySectionOf({&held}, 1'000'000).end, "runs");
  const auto links = held.arm.model.links();
  const json& frames = page["robot"]["frames"];
  ASSERT_EQ(frames.size(), links.size());
  for (std::size_t i = 0; i < links.size(); ++i) EXPECT_EQ(frames[i], links[i].name);

  const auto index = static_cast<std::size_t>(held.log["push_1.force"]["link"](0));
  EXPECT_EQ(frames.at(index), "tool_frame");
}

}  // namespace
}  // namespace pliant
