#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/exchange/sequence_file.h"
#include "app/exchange/sequence_summary.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::filesystem::path sequence;
  std::vector<std::filesystem::path> calibrations;
  bool json = false;
};

// The first few of a list; the whole of it is in the JSON.
constexpr std::size_t shown = 8;

void print_rest(std::size_t all) {
  if (all > shown) std::printf("    and %zu more\n", all - shown);
}

void print_time(const Json& time, int frames) {
  if (time["stamped"] == 0) {
    std::printf("time: no time stamps\n");
    return;
  }
  std::printf("time: %.3f s at %.2f Hz (%d of %d frames stamped, %d not later than the one before)\n",
              time["duration_s"].get<double>(), time["rate_hz"].get<double>(), time["stamped"].get<int>(),
              frames, time["not_increasing"].get<int>());
  const Json& gaps = time["gaps"];
  std::printf("gaps in time: %zu\n", gaps.size());
  for (std::size_t i = 0; i < std::min(gaps.size(), shown); ++i)
    std::printf("    after frame %d: %.3f s\n", gaps[i]["after_frame"].get<int>(),
                gaps[i]["s"].get<double>());
  print_rest(gaps.size());
}

void print_motion(const Json& motion) {
  if (motion.is_null()) {
    std::printf("motion: nothing is tracked in Reference or Tracker\n");
    return;
  }
  std::printf("motion of %s in %s: %d frames with a pose, path %.1f mm\n",
              motion["of"].get<std::string>().c_str(), motion["in"].get<std::string>().c_str(),
              motion["frames"].get<int>(), motion["path_mm"].get<double>());
  std::printf("  spacing of frames: median %.3f mm, largest %.3f mm\n",
              motion["spacing_mm"]["median"].get<double>(), motion["spacing_mm"]["max"].get<double>());
  std::printf("  speed: median %.1f mm/s, largest %.1f mm/s\n", motion["speed_mm_s"]["median"].get<double>(),
              motion["speed_mm_s"]["max"].get<double>());
  std::printf("  pose jumps: %zu\n", motion["jumps"].size());
  for (std::size_t i = 0; i < std::min(motion["jumps"].size(), shown); ++i)
    std::printf("    after frame %d: %.2f mm\n", motion["jumps"][i]["after_frame"].get<int>(),
                motion["jumps"][i]["mm"].get<double>());
  print_rest(motion["jumps"].size());
  std::printf("  runs of frames without a pose: %zu\n", motion["without_pose"].size());
  for (std::size_t i = 0; i < std::min(motion["without_pose"].size(), shown); ++i)
    std::printf("    frames %d to %d\n", motion["without_pose"][i][0].get<int>(),
                motion["without_pose"][i][1].get<int>());
  print_rest(motion["without_pose"].size());
  if (motion.contains("pixel_mm"))
    std::printf("  pixel: %.4f x %.4f mm, axes at %.2f degrees\n", motion["pixel_mm"][0].get<double>(),
                motion["pixel_mm"][1].get<double>(), motion["axes_deg"].get<double>());
}

void print(const Json& json) {
  const int frames = json["frames"];
  std::printf("%s\n", json["file"].get<std::string>().c_str());
  std::printf("%d frames of %d x %d", frames, json["width"].get<int>(), json["height"].get<int>());
  if (json["slices"] != 1) std::printf(" x %d", json["slices"].get<int>());
  std::printf(", %d component%s of %s, %s, orientation %s%s\n", json["components"].get<int>(),
              json["components"] == 1 ? "" : "s", json["element_type"].get<std::string>().c_str(),
              json["image_type"].get<std::string>().c_str(), json["orientation"].get<std::string>().c_str(),
              json["compressed"].get<bool>() ? ", compressed" : "");
  std::printf("pictures: %d OK, %d invalid\n", json["pictures"]["ok"].get<int>(),
              json["pictures"]["invalid"].get<int>());
  print_time(json["time"], frames);
  for (const Json& row : json["transforms"]) {
    std::printf("%s: in %d frames", row["name"].get<std::string>().c_str(), row["frames"].get<int>());
    for (const auto& [status, count] : row["status"].items())
      std::printf(", %d %s", count.get<int>(), status.c_str());
    if (row["status_missing"] != 0) std::printf(", %d without a status", row["status_missing"].get<int>());
    if (row["not_a_pose"] != 0) std::printf(", %d are no pose", row["not_a_pose"].get<int>());
    std::printf("\n");
  }
  print_motion(json["motion"]);
  for (const Json& warning : json["warnings"])
    std::printf("warning: %s\n", warning.get<std::string>().c_str());
}

void info(const Options& options) {
  const exchange::ReadSequence read = exchange::read_sequence(options.sequence);
  std::optional<exchange::PlusConfig> config;
  if (!options.calibrations.empty()) config = exchange::read_plus_configs(options.calibrations);
  const Json json = exchange::summarise(read, config, options.sequence.string());
  if (options.json)
    std::printf("%s\n", json.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
  else
    print(json);
}

}  // namespace

void add_info(CLI::App& tool) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = tool.add_subcommand("info", "What a tracked sequence holds, and how it was moved");
  verb->add_option("SEQ", options->sequence, "Sequence: .mha, .mhd or .nrrd")->required();
  verb->add_option("--calibration", options->calibrations, "PLUS configuration (XML); may be given again")
      ->expected(1)
      ->take_all();
  verb->add_flag("--json", options->json, "Print JSON");
  verb->callback([options] { info(*options); });
}

}  // namespace sonoband::tools
