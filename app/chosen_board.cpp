#include "app/chosen_board.h"

#include <cstdio>

#include "app/bad_input.h"
#include "app/exchange/recording.h"
#include "app/exchange/sequence_file.h"

namespace sonoband {
namespace {

constexpr std::string_view replay = "replay:";

// As profiles and checks know it.
std::string kind_of(const BoardChoice& choice) {
  return choice.board.starts_with(replay) ? "replay" : choice.board;
}

// Where the pixels of the cart's pictures lie, as a calibration wrote it.
BoardCalibration calibration_of(const BoardChoice& choice, const Profile& profile) {
  if (choice.calibration.empty())
    throw BadInput(
        "--board " + choice.board +
        ": a cart needs to know where its pixels lie; name the calibration (XML) in --calibration");
  const exchange::PlusConfig config = exchange::read_plus_config(choice.calibration);
  const auto [width, height] = profile.capture.size_px;
  return {
      .probe_from_image = exchange::probe_from_image(config, choice.calibration),
      .mask = exchange::sector_mask(width, height, config.clip, std::nullopt, config.fan, choice.calibration),
      .latency_offset = {}};
}

BoardDevices replayed(const BoardChoice& choice, const Profile& profile, Clock& clock) {
  const std::string file = choice.board.substr(replay.size());
  const exchange::PlusConfig config =
      choice.calibration.empty() ? exchange::PlusConfig{} : exchange::read_plus_config(choice.calibration);
  exchange::ReplayMaterial material = exchange::replay_material(exchange::read_sequence(file), config, file);
  for (const std::string& warning : material.warnings)
    std::fprintf(stderr, "sonoband: %s\n", warning.c_str());
  return make_replay_board(material.recording, material.probe_from_image, std::move(material.mask), profile,
                           clock);
}

}  // namespace

Profile profile_of(const BoardChoice& choice) {
  const Profile defaults = board_profile(kind_of(choice)).value_or(Profile{});
  return choice.config.empty() ? defaults : read_profile(choice.config, defaults);
}

BoardDevices devices_of(const BoardChoice& choice, const Profile& profile, Clock& clock) {
  if (choice.board == "sim") return make_sim_board(profile, clock);
  if (choice.board == "virtual")
    return make_hardware_board(choice.board, scene_calibration(profile), profile, clock);
  if (choice.board != "replay" && board_profile(choice.board))
    return make_hardware_board(choice.board, calibration_of(choice, profile), profile, clock);
  if (choice.board.starts_with(replay)) return replayed(choice, profile, clock);
  throw BadInput(
      "--board " + choice.board +
      ": there are the boards sim, replay:FILE, cart, raspberrypi and virtual; choose one of them");
}

std::vector<CheckLine> check_of(const BoardChoice& choice) {
  const std::string board = kind_of(choice);
  if (!board_profile(board))
    throw BadInput("--board " + choice.board +
                   ": there are the boards sim, replay, cart, raspberrypi and virtual");
  return check_board(board, profile_of(choice));
}

}  // namespace sonoband
