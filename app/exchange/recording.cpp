#include "app/exchange/recording.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "app/bad_input.h"
#include "app/exchange/grey_pixels.h"
#include "app/exchange/sweep_from_sequence.h"
#include "app/exchange/transform_graph.h"

namespace sonoband::exchange {
namespace {

Rigid<frame::Tracker, frame::Probe> rigid_of(const Eigen::Matrix4d& m) {
  return {m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>()};
}

Stamp stamp_of(const TrackedSequence& s, int i, std::optional<double>& last, const std::string& file) {
  const auto t = timestamp_s(s.frames[i]);
  if (!t || (last && !(*t > *last))) {
    throw BadInput(
        fmt::format("{}: frame {} has {}; a replay needs stamps that rise, so convert or trim the recording.",
                    file, i, t ? "no later time stamp than the frame before" : "no time stamp"));
  }
  last = t;
  return Stamp(from_seconds(*t));
}

}  // namespace

ReplayMaterial replay_material(ReadSequence&& read, const PlusConfig& config, const std::string& file) {
  ReplayMaterial material;
  material.warnings = std::move(read.warnings);
  auto sequence = std::make_shared<TrackedSequence>(std::move(read.sequence));
  if (!sequence->has_pictures() || sequence->frame_count() == 0 || sequence->slices > 1) {
    throw BadInput(file +
                   ": it holds no 2-D pictures, so there is nothing to replay; name a recording of B-scans.");
  }
  const bool colour = sequence->components == 3 && sequence->element_type == ElementType::uint8;
  if (!colour) make_grey(*sequence, file, material.warnings);

  auto recording = std::make_shared<Recording>();
  const TransformGraph shared = shared_transforms(*sequence, &config, file);
  const std::string world = default_world(*sequence);
  bool calibrated = false;
  std::optional<double> last;
  for (int i = 0; i < sequence->frame_count(); ++i) {
    const std::string place = fmt::format("{}, frame {}", file, i);
    const auto own = transforms_of(sequence->frames[i].fields, place);
    const TransformGraph graph = shared.with(own, place);
    const Stamp stamp = stamp_of(*sequence, i, last, file);
    const int bytes = colour ? 3 : 1;
    recording->frames.push_back({.data = sequence->frame_pixels(i).data(),
                                 .width = sequence->width,
                                 .height = sequence->height,
                                 .stride_bytes = std::ptrdiff_t{sequence->width} * bytes,
                                 .format = colour ? PixelFormat::rgb24 : PixelFormat::grey8,
                                 .captured = stamp,
                                 .sequence = static_cast<std::uint64_t>(i)});
    const auto pose = world.empty() ? std::nullopt : graph.find(world, "Probe");
    RecordedPose recorded{.time = stamp, .quality = PoseQuality::missing};
    if (pose && pose->ok) {
      recorded.tracker_from_probe = rigid_of(pose->to_from_from);
      recorded.quality = PoseQuality::good;
    }
    recording->poses.push_back(recorded);
    if (calibrated) continue;
    if (const auto calibration = graph.find("Probe", "Image"); calibration && calibration->ok) {
      material.probe_from_image = {calibration->to_from_from.topLeftCorner<3, 3>(),
                                   calibration->to_from_from.topRightCorner<3, 1>()};
      calibrated = true;
    }
  }
  if (!calibrated) {
    throw BadInput(file +
                   ": no transform leads from Image to Probe; give --calibration with a Transform "
                   "From=\"Image\" To=\"Probe\".");
  }
  if (sequence->orientation == "MFA") {
    material.mask = sector_mask(sequence->width, sequence->height, config.clip, {}, config.fan, file);
  }
  recording->pixels = sequence;
  material.recording = std::move(recording);
  return material;
}

Affine<frame::Probe, frame::Image> probe_from_image(const PlusConfig& config, const std::string& file) {
  TransformGraph graph;
  graph.add(config.transforms);
  const auto found = graph.find("Probe", "Image");
  if (!found || !found->ok)
    throw BadInput(file + ": no transform leads from Image to Probe; calibrate, or name another file.");
  return {found->to_from_from.topLeftCorner<3, 3>(), found->to_from_from.topRightCorner<3, 1>()};
}

}  // namespace sonoband::exchange
