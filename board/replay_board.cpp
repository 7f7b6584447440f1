#include <cassert>

#include "board/devices.h"
#include "hal/replay/replay.h"
#include "hal/sim/sim_footswitch.h"

namespace sonoband {

BoardDevices make_replay_board(std::shared_ptr<const Recording> recording,
                               const Affine<frame::Probe, frame::Image>& probe_from_image, Pixels mask,
                               const Profile& profile, Clock& clock) {
  assert(!recording->frames.empty());
  BoardDevices devices;
  devices.board = "replay";
  devices.width_px = recording->frames.front().width;
  devices.height_px = recording->frames.front().height;
  devices.mask = std::move(mask);
  devices.probe_from_image = probe_from_image;
  // What a recording pairs is in its stamps; only the profile can say that it was wrong.
  devices.latency_offset = from_seconds(profile.capture.latency_ms.value_or(0) / 1000);

  const auto timeline = std::make_shared<ReplayTimeline>(clock, std::move(recording), ReplayMode::loop);
  devices.tracker = std::make_unique<ReplayTracker>(timeline);
  devices.frames = std::make_unique<ReplayFrameSource>(timeline);
  auto footswitch = std::make_unique<sim::SimFootswitch>(clock, sim::FootswitchSettings{});
  devices.foot = [foot = footswitch.get()](bool down) { return down ? foot->press() : foot->release(); };
  devices.footswitch = std::move(footswitch);
  return devices;
}

}  // namespace sonoband
