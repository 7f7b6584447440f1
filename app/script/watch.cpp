#include "app/script/watch.h"

#include <chrono>

namespace sonoband::script {
namespace {

constexpr Duration counts_every = std::chrono::milliseconds(500);

const char* word(DeviceState state) {
  switch (state) {
    case DeviceState::absent:
      return "absent";
    case DeviceState::starting:
      return "starting";
    case DeviceState::running:
      return "running";
    case DeviceState::degraded:
      return "degraded";
    case DeviceState::stalled:
      return "stalled";
    case DeviceState::fault:
      return "fault";
  }
  return "?";
}

}  // namespace

std::optional<std::string> Watch::line(const cart::ApplianceStatus& status) {
  if (status.at == Stamp{}) return std::nullopt;  // the cart has not said anything yet
  const cart::CartStatus& cart = status.cart;
  nlohmann::ordered_json states{{"state", cart::name_of(cart.state)},
                                {"note", cart::sentence_of(cart.note)},
                                {"tracker", word(status.tracker.health.state)},
                                {"video", word(status.frames.health.state)},
                                {"pedal", word(status.pedal.health.state)},
                                {"down", cart.pedal_down},
                                {"armed", cart.pedal_armed},
                                {"lost_edges", cart.lost_edges}};
  if (told_at_ && states == told_ && status.at - *told_at_ < counts_every) return std::nullopt;
  told_ = states;
  told_at_ = status.at;
  nlohmann::ordered_json line{{"at", seconds(status.at.time_since_epoch())}};
  line.update(states);
  line["readings"] = cart.acquisition.ledger.poses;
  line["pictures"] = cart.acquisition.ledger.received;
  line["frames"] = status.saving ? status.saving->published : 0;
  line["saved"] = status.saving ? status.saving->stored : 0;
  return line.dump();
}

}  // namespace sonoband::script
