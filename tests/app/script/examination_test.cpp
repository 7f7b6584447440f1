// A short examination on the simulated cart, from the pedal to the pictures, on a clock that jumps.
#include "app/script/examination.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <numeric>
#include <sstream>

#include "app/cart_on_board.h"
#include "app/exchange/png.h"
#include "hal/sim/virtual_clock.h"

namespace sonoband::script {
namespace {

struct Cart {
  Cart() {
    Profile profile;
    profile.ring.frames = 200;
    board = make_sim_board(profile, *clock);
    appliance = make_appliance(board, profile, clock);
  }

  nlohmann::ordered_json run(const std::string& text, const std::filesystem::path& out) {
    const ClockMember member(*clock);
    Serial serial;
    appliance->start();
    Stage stage{*appliance, board.foot, board.views, *clock, serial, out};
    nlohmann::ordered_json summary;
    std::string failure;
    try {
      summary = script::run(parse(text, "test"), "test", stage);
    } catch (const ScriptFailed& e) {
      failure = e.what();
    }
    appliance->stop();
    if (!failure.empty()) summary["failure"] = failure;
    return summary;
  }

  std::shared_ptr<sim::VirtualClock> clock = std::make_shared<sim::VirtualClock>();
  BoardDevices board;
  std::unique_ptr<cart::Appliance> appliance;
};

std::filesystem::path scratch() {
  auto folder = std::filesystem::temp_directory_path() /
                (std::string("sonoband-") + ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                 std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  return folder;
}

double mean_of(const std::filesystem::path& file) {
  const auto png = exchange::read_png(file);
  return std::accumulate(png.bytes.begin(), png.bytes.end(), 0.0) / static_cast<double>(png.bytes.size());
}

TEST(Examination, PressSweepReleaseGivesBandsAndABalancedLedger) {
  const auto out = scratch();
  Cart cart;
  const auto summary = cart.run(R"(await live 5
wait 2
press
wait 3
release
await review 5
wait 1
render thin.png view=upright
render thick.png view=upright thickness-mm=14
)",
                                out);
  ASSERT_FALSE(summary.contains("failure")) << summary["failure"];
  ASSERT_EQ(summary["sweeps"].size(), 1u);
  const auto& sweep = summary["sweeps"][0];
  // 3 s at 30 frames a second; the first after the press is at most one frame period away.
  EXPECT_NEAR(sweep["frames"].get<int>(), 90, 2);
  EXPECT_EQ(sweep["frames"], sweep["frames_with_pose"]);
  EXPECT_LT(sweep["first_frame_after_press_ms"].get<double>(), 1000.0 / 30);
  EXPECT_GT(sweep["pre_roll_frames"].get<int>(), 25);
  EXPECT_EQ(sweep["ledger"]["stored"], sweep["ledger"]["received"]);
  // Maximum over 71 layers is brighter than one of them.
  EXPECT_GT(mean_of(out / "thick.png"), mean_of(out / "thin.png") + 5);
  std::filesystem::remove_all(out);
}

TEST(Examination, WhoWatchesReadsEveryStateEverySweepAndEveryPicture) {
  const auto out = scratch();
  Cart cart;
  ::testing::internal::CaptureStdout();
  const auto summary = cart.run(R"(watch
await live 5
wait 2
press
await recording 1
wait 3
release
await review 5
wait 1
render thin.png
)",
                                out);
  std::istringstream said(::testing::internal::GetCapturedStdout());
  std::filesystem::remove_all(out);
  ASSERT_FALSE(summary.contains("failure")) << summary["failure"];
  std::vector<std::string> states;
  std::vector<nlohmann::ordered_json> sweeps;
  nlohmann::ordered_json newest;
  int pictures = 0;
  for (std::string line; std::getline(said, line);) {
    const auto json = nlohmann::ordered_json::parse(line, nullptr, false);
    if (json.contains("sweep")) sweeps.push_back(json["sweep"]);
    if (json.contains("picture")) ++pictures;
    if (!json.contains("state")) continue;
    const auto state = json["state"].get<std::string>();
    if (states.empty() || states.back() != state) states.push_back(state);
    if (!newest.is_null()) {
      EXPECT_LE(json["at"].get<double>() - newest["at"].get<double>(), 0.6);
    }
    newest = json;
  }
  EXPECT_EQ(states, (std::vector<std::string>{"idle", "live", "recording", "review"}));
  EXPECT_EQ(newest["tracker"], "running");
  EXPECT_FALSE(newest["down"]);
  EXPECT_GT(newest["readings"].get<int>(), 200);
  ASSERT_EQ(sweeps.size(), 1u);
  EXPECT_EQ(sweeps[0], summary["sweeps"][0]);
  EXPECT_EQ(pictures, 1);
}

TEST(Examination, SaysWhatDidNotHappenAndWhere) {
  const auto out = scratch();
  EXPECT_EQ(Cart().run("await review 1\n", out)["failure"],
            "test:1: the cart was to be in review within 1 s and is in live");
  EXPECT_EQ(Cart().run("\nrender a.png\n", out)["failure"],
            "test:2: there is no sweep yet to make a picture of; press, wait, release first");
  std::filesystem::remove_all(out);
}

}  // namespace
}  // namespace sonoband::script
