#include "app/cart_on_board.h"

#include "app/bad_input.h"

namespace sonoband {
namespace {

// The crop as captured, and where its first pixel is in the whole picture once that is turned to MF.
struct CropPlan {
  cart::Crop crop;
  int width = 0;
  int height = 0;
  int mf_x = 0;
  int mf_y = 0;
};

CropPlan plan_crop(const BoardDevices& board, const Profile& profile) {
  const auto [x, y, width, height] = profile.capture.crop_px;
  CropPlan plan;
  const bool whole = width == 0 && height == 0;
  plan.width = whole ? board.width_px : width;
  plan.height = whole ? board.height_px : height;
  if (plan.width < 1 || plan.height < 1 || x + plan.width > board.width_px ||
      y + plan.height > board.height_px) {
    throw BadInput("capture.crop-px asks for " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels from (" + std::to_string(x) + ", " + std::to_string(y) +
                   "), but the captured picture is " + std::to_string(board.width_px) + " x " +
                   std::to_string(board.height_px) + "; choose a crop within it, or leave the key out");
  }
  plan.crop.x = x;
  plan.crop.y = y;
  plan.crop.flip_x = profile.capture.orientation[0] == 'U';
  plan.crop.flip_y = profile.capture.orientation[1] == 'N';
  plan.mf_x = plan.crop.flip_x ? board.width_px - x - plan.width : x;
  plan.mf_y = plan.crop.flip_y ? board.height_px - y - plan.height : y;
  return plan;
}

Pixels cropped_mask(const Pixels& mask, const CropPlan& plan) {
  if (mask.view().empty()) return {};
  Pixels result(plan.width, plan.height);
  for (int y = 0; y < plan.height; ++y) {
    for (int x = 0; x < plan.width; ++x) result.view()(x, y) = mask.view()(x + plan.mf_x, y + plan.mf_y);
  }
  return result;
}

Duration from_ms(double ms) {
  return from_seconds(ms / 1000);
}

// What every sweep of this cart has in common.
std::unique_ptr<exam::CartExams> make_exams(const std::filesystem::path& place, const BoardDevices& board,
                                            const Profile& profile, const CropPlan& plan,
                                            const cart::AcquisitionSettings& acquisition, const Pixels& mask,
                                            const std::shared_ptr<Clock>& clock) {
  exam::CartExamsSettings settings;
  settings.place = place;
  exam::SweepSetup& sweep = settings.sweep;
  sweep.width = plan.width;
  sweep.height = plan.height;
  sweep.kind = acquisition.flow ? PixelKind::doppler : PixelKind::grey;
  sweep.frames_per_second = profile.capture.rate_hz;
  sweep.probe_from_image = acquisition.probe_from_image;
  sweep.calibration_name = "of the board " + board.board;
  sweep.latency_offset = acquisition.pairing.latency_offset;
  sweep.crop = {plan.crop.x, plan.crop.y, plan.width, plan.height};
  sweep.mask = mask.copy();
  sweep.versions = {{"sonoband", SONOBAND_VERSION},
                    {"board", board.board},
                    {"captured orientation", profile.capture.orientation}};
  settings.recorder.reserve_bytes = std::int64_t{profile.exams.reserve_mb} << 20;
  settings.recorder.bytes_per_second = profile.capture.rate_hz * plan.width * plan.height;
  settings.recorder.now = [clock] { return clock->now(); };
  return std::make_unique<exam::CartExams>(std::move(settings));
}

}  // namespace

doppler::ColourBar colour_bar_of(const Profile& profile) {
  doppler::ColourBar bar = doppler::red_blue_bar();
  const auto take = [](const std::vector<std::array<std::uint8_t, 3>>& colours, auto& levels) {
    std::vector<doppler::Rgb> rgb;
    for (const auto& [r, g, b] : colours) rgb.push_back({r, g, b});
    if (!rgb.empty()) levels = doppler::ramp(rgb);
  };
  take(profile.capture.towards, bar.red);
  take(profile.capture.away, bar.blue);
  return bar;
}

std::unique_ptr<cart::Appliance> make_appliance(BoardDevices& board, const Profile& profile,
                                                std::shared_ptr<Clock> clock,
                                                const std::filesystem::path& place_of_exams) {
  const CropPlan plan = plan_crop(board, profile);
  cart::ApplianceSettings settings;
  settings.ring.width = plan.width;
  settings.ring.height = plan.height;
  settings.ring.slots = static_cast<std::uint32_t>(profile.ring.frames);

  if (profile.capture.colour == "doppler") {
    settings.ring.kind = PixelKind::doppler;
    doppler::ColourThresholds thresholds;
    thresholds.chroma = profile.capture.chroma;
    settings.cart.acquisition.flow =
        std::make_shared<FlowKeys>(doppler::ColourClassifier(colour_bar_of(profile), thresholds));
  }

  const bool real_devices = !board.foot;
  settings.priority = real_devices ? 40 : 0;

  cart::AcquisitionSettings& acquisition = settings.cart.acquisition;
  acquisition.source_width = board.width_px;
  acquisition.source_height = board.height_px;
  acquisition.crop = plan.crop;
  Affine<frame::Image, frame::Image> whole_from_crop;
  whole_from_crop.translation = {static_cast<double>(plan.mf_x), static_cast<double>(plan.mf_y), 0};
  acquisition.probe_from_image = board.probe_from_image * whole_from_crop;
  acquisition.pairing.latency_offset = board.latency_offset;
  acquisition.pairing.wait = from_ms(profile.tracking.wait_ms);
  acquisition.pose.gap = from_ms(profile.tracking.gap_ms);
  acquisition.pre_roll = from_seconds(profile.ring.pre_roll_s);
  settings.cart.frames_silent = from_ms(profile.capture.silent_ms);
  settings.cart.machine.pedal = profile.pedal.mode;
  settings.cart.machine.longest = from_seconds(profile.pedal.stuck_s);
  settings.cart.debounce.quiet = from_ms(profile.pedal.debounce_ms);
  settings.cart.debounce.stuck_limit = from_seconds(profile.pedal.stuck_s);

  const Pixels mask = cropped_mask(board.mask, plan);
  std::unique_ptr<exam::CartExams> exams;
  if (!place_of_exams.empty())
    exams = make_exams(place_of_exams, board, profile, plan, acquisition, mask, clock);
  cart::Devices devices;
  devices.clock = std::move(clock);
  devices.belongings = {board.parts};
  devices.tracker = std::move(board.tracker);
  devices.frames = std::move(board.frames);
  devices.pedal = std::move(board.footswitch);
  devices.on_recording = board.on_recording;
  return std::make_unique<cart::Appliance>(std::move(devices), settings, mask.view(), std::move(exams));
}

}  // namespace sonoband
