// The speed table as it is printed and written, from figures that are given.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/bad_input.h"
#include "tests/bench/table/table.h"

namespace sonoband::bench {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

class SpeedTable : public testing::Test {
 protected:
  SpeedTable()
      : folder(std::filesystem::temp_directory_path() / ("sonoband_table_" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder);
  }
  ~SpeedTable() override { std::filesystem::remove_all(folder); }

  // Counts how often a figure is asked for.
  Case given(const std::string& name, double ms, Asked asked = {}) {
    Case c;
    c.name = name;
    c.ms = asked;
    c.own_ms = [this, ms] {
      ++taken;
      return ms;
    };
    return c;
  }
  std::vector<Case> cases() {
    std::vector<Case> all{given("bands N=200", 2, {5, 1}), given("bands N=4000", 7),
                          given("flow", 3, {2, 0})};
    all[1].base = "bands N=200";
    all[1].times = {3, 1.5};
    all[1].left_out = [] { return 3420; };
    return all;
  }
  std::string print(const std::string& filter, const Output& output) {
    testing::internal::CaptureStdout();
    measure(cases(), filter, output, Clock::wall, 1);
    return testing::internal::GetCapturedStdout();
  }
  std::string refusal(const std::string& filter, const Output& output) {
    try {
      print(filter, output);
    } catch (const BadInput& e) {
      testing::internal::GetCapturedStdout();
      return e.what();
    }
    return "none";
  }
  static Json read(const std::string& file) { return Json::parse(std::ifstream(file)); }

  const std::filesystem::path folder;
  int taken = 0;
};

TEST_F(SpeedTable, RowsHaveWhatIsAskedAndStarsWhereItIsMissed) {
  const std::string text = print("", {});
  EXPECT_THAT(text, HasSubstr("peer: none"));
  EXPECT_THAT(text, HasSubstr("2.000     5     1\n"));
  EXPECT_THAT(text, HasSubstr("3.50*    3   1.5   3420\n"));  // 7 of 2
  EXPECT_THAT(text, HasSubstr("3.000*    2      \n"));
}

// The contract of --json: peer's fields only with a peer.
TEST_F(SpeedTable, JsonHasTheRowsAndNothingOfAPeerWithoutOne) {
  const std::string file = (folder / "speed.json").string();
  print("", {"", file});
  const Json json = read(file);
  EXPECT_EQ(json.size(), 2U);
  EXPECT_THAT(json["machine"].get<std::string>(), HasSubstr(" cores"));
  ASSERT_EQ(json["rows"].size(), 3U);
  EXPECT_EQ(json["rows"][0],
            Json({{"case", "bands N=200"}, {"ours_ms", 2.0}, {"must_ms", 5.0}, {"aim_ms", 1.0}}));
  EXPECT_EQ(json["rows"][1], Json({{"case", "bands N=4000"},
                                   {"ours_ms", 7.0},
                                   {"base", "bands N=200"},
                                   {"times", 3.5},
                                   {"must_times", 3.0},
                                   {"aim_times", 1.5},
                                   {"frames_left_out", 3420}}));
}

TEST_F(SpeedTable, JsonHasThePeersTimesAndTheRatio) {
  const std::string file = (folder / "speed.json").string();
  Case c = given("slab", 0.5);
  c.ratio.must = 3;
  c.peer = [] {};
  testing::internal::CaptureStdout();
  measure({c}, "", {"a peer", file}, Clock::processor, 1);
  testing::internal::GetCapturedStdout();
  const Json json = read(file);
  EXPECT_EQ(json["peer"], "a peer");
  const Json& row = json["rows"][0];
  EXPECT_EQ(row["must_ratio"], 3.0);
  EXPECT_EQ(row["ratio"].get<double>(), row["vtk_ms"].get<double>() / 0.5);
}

TEST_F(SpeedTable, AFilterBringsWhatItsCasesAreMultiplesOf) {
  const std::string text = print("N=4000", {});
  EXPECT_THAT(text, HasSubstr("bands N=200"));
  EXPECT_THAT(text, HasSubstr("3.50*"));
  EXPECT_THAT(text, Not(HasSubstr("flow")));
}

TEST_F(SpeedTable, WhatCannotBeDoneIsSaidBeforeAnythingIsMeasured) {
  EXPECT_EQ(refusal("N=300", {}), "no case has 'N=300' in its name; run without --filter to see the names");
  const std::string nowhere = (folder / "none" / "speed.json").string();
  EXPECT_THAT(refusal("", {"", nowhere}),
              HasSubstr(nowhere + ": cannot be written: the folder is not there"));
  EXPECT_EQ(taken, 0);
}

}  // namespace
}  // namespace sonoband::bench
