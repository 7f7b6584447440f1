#include "app/exchange/exam_sequence.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/bad_input.h"
#include "app/exam/setup_json.h"
#include "app/exchange/sweep_from_sequence.h"
#include "app/exchange/text.h"

namespace sonoband::exchange {

namespace {

constexpr std::string_view setup_field = "SonobandSetup";
// PLUS reads headers through a buffer of 1000 bytes a line.
constexpr std::size_t longest_value = 800;

Eigen::Matrix4d matrix(const Eigen::Matrix3d& linear, const Eigen::Vector3d& translation) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = linear;
  m.topRightCorner<3, 1>() = translation;
  return m;
}

std::int64_t ns(Stamp t) {
  return t.time_since_epoch().count();
}

void step(const Progress& progress, std::size_t done, std::size_t all) {
  if (progress && !progress(static_cast<int>(done * 1000 / std::max<std::size_t>(all, 1))))
    throw BadInput("stopped before the end; nothing was written.");
}

// Long text in header fields, between bars so that blanks at the ends survive.
void put_long(std::vector<Field>& fields, std::string_view name, const std::string& text) {
  for (std::size_t at = 0, part = 0; at < text.size(); at += longest_value, ++part)
    fields.push_back({fmt::format("{}{}", name, part), "|" + text.substr(at, longest_value) + "|"});
}
std::string take_long(std::vector<Field>& fields, std::string_view name) {
  std::string text;
  for (std::size_t part = 0;; ++part) {
    const std::string field = fmt::format("{}{}", name, part);
    const std::string* value = find_field(fields, field);
    if (value == nullptr || value->size() < 2) break;
    text += value->substr(1, value->size() - 2);
  }
  return text;
}

std::vector<std::int64_t> integers(const std::vector<Field>& fields, std::string_view name) {
  std::vector<std::int64_t> all;
  if (const std::string* value = find_field(fields, name); value != nullptr) {
    for (const std::string_view word : split_blanks(*value))
      if (const auto number = parse_integer(word)) all.push_back(*number);
  }
  return all;
}

}  // namespace

ExportedSweep sequence_from_exam(const exam::ExamReader& exam, std::int64_t sweep, const Progress& progress) {
  ExportedSweep out;
  out.setup = exam.setup(sweep);
  exam::StoredFrames stored = exam.frames(sweep);
  out.damage = std::move(stored.damage);
  TrackedSequence& s = out.sequence;
  s.width = out.setup.width;
  s.height = out.setup.height;
  s.element_type = ElementType::uint8;
  s.orientation = "MFA";
  s.image_type = "BRIGHTNESS";
  put_long(s.fields, setup_field, exam::to_json(out.setup));
  if (s.frame_bytes() > 0 && stored.frames.size() > default_limits().max_pixel_bytes / s.frame_bytes())
    throw BadInput(
        fmt::format("sweep {}: {} pictures do not fit this machine's memory.", sweep, stored.frames.size()));
  // Pictures that cannot be read are left out, so the buffer is filled first and counted afterwards.
  PixelBuffer pixels(stored.frames.size() * s.frame_bytes());
  for (std::size_t i = 0; i < stored.frames.size(); ++i) {
    const exam::FrameRecord& r = stored.frames[i].record;
    std::uint8_t* const to = pixels.bytes().data() + s.frames.size() * s.frame_bytes();
    std::string damage = exam.pixels(sweep, stored.frames[i], {to, s.width, s.height, s.width});
    if (!damage.empty()) {
      out.damage.push_back(std::move(damage));
      continue;
    }
    SequenceFrame frame;
    const bool ok = r.pose_status == PoseStatus::ok;
    set_transform(frame, {"Image", out.setup.world},
                  matrix(r.world_from_image.linear, r.world_from_image.translation), ok ? "OK" : "INVALID");
    if (r.tracker_from_probe && out.setup.world == "Tracker")
      set_transform(frame, {"Probe", "Tracker"},
                    matrix(r.tracker_from_probe->rotation, r.tracker_from_probe->translation),
                    ok ? "OK" : "INVALID");
    set_field(frame.fields, "Timestamp", format_number(seconds(r.captured)));
    set_field(frame.fields, "UnfilteredTimestamp", format_number(seconds(r.stamped)));
    set_field(frame.fields, "FrameNumber", std::to_string(r.device_count));
    set_field(frame.fields, "ImageStatus", "OK");
    set_field(frame.fields, "SonobandStampsNs",
              fmt::format("{} {} {} {}", ns(r.captured), ns(r.stamped), ns(r.arrived), r.device_ns));
    set_field(frame.fields, "SonobandState",
              fmt::format("{} {}", static_cast<int>(r.pose_status), r.pre_roll ? 1 : 0));
    s.frames.push_back(std::move(frame));
    step(progress, i + 1, stored.frames.size());
  }
  if (s.frames.size() < stored.frames.size()) {
    PixelBuffer fewer(s.frames.size() * s.frame_bytes());
    std::copy_n(pixels.bytes().data(), fewer.bytes().size(), fewer.bytes().data());
    pixels = std::move(fewer);
  }
  s.pixels = std::move(pixels);
  return out;
}

std::string plus_config_xml(const exam::SweepSetup& setup) {
  if (!setup.probe_from_image) return {};
  const std::string m =
      format_matrix(matrix(setup.probe_from_image->linear, setup.probe_from_image->translation));
  return fmt::format(
      "<PlusConfiguration version=\"2.1\">\n  <CoordinateDefinitions>\n    <Transform From=\"Image\" "
      "To=\"Probe\" "
      "Matrix=\"{}\" Error=\"{}\" />\n  </CoordinateDefinitions>\n</PlusConfiguration>\n",
      m, format_number(setup.calibration_error_mm));
}

std::vector<std::string> sequence_into_exam(ReadSequence&& read, const PlusConfig& config, Pixels mask,
                                            const std::string& file, exam::ExamWriter& exam,
                                            const Progress& progress) {
  exam::SweepSetup setup;
  const std::string json = take_long(read.sequence.fields, setup_field);
  if (!json.empty()) {
    try {
      setup = exam::setup_from_json(json);
    } catch (const std::exception& e) {
      throw BadInput(
          fmt::format("{}: its SonobandSetup fields are damaged ({}); take them out to import it as a "
                      "plain sequence.",
                      file, e.what()));
    }
  }
  if (const std::string* kind = find_field(read.sequence.fields, "SonobandPixels");
      kind != nullptr && *kind == "doppler")
    setup.kind = PixelKind::doppler;
  SweepRequest request;
  if (!json.empty()) request.world = setup.world;
  SequenceSweep sweep = sweep_from_sequence(std::move(read), config, request, file);
  const TrackedSequence& s = sweep.sequence;
  setup.width = s.width;
  setup.height = s.height;
  setup.world = sweep.world;
  for (const ConfigTransform& t : config.transforms) {
    if (t.name != TransformName{"Image", "Probe"}) continue;
    setup.probe_from_image.emplace();
    setup.probe_from_image->linear = t.to_from_from.topLeftCorner<3, 3>();
    setup.probe_from_image->translation = t.to_from_from.topRightCorner<3, 1>();
    setup.calibration_error_mm = parse_number(t.error).value_or(0);
    setup.calibration_name = t.date.empty() ? t.place : t.place + ", " + t.date;
  }
  if (mask.width() > 0 && (mask.width() != s.width || mask.height() != s.height))
    throw BadInput(fmt::format("{}: the mask has {} x {} pixels, the pictures {} x {}.", file, mask.width(),
                               mask.height(), s.width, s.height));
  if (mask.width() > 0 && sweep.mask.width() > 0) {
    for (int y = 0; y < s.height; ++y)
      for (int x = 0; x < s.width; ++x)
        if (sweep.mask.view()(x, y) == 0) mask.view()(x, y) = 0;
  }
  setup.mask = mask.width() > 0 ? std::move(mask) : std::move(sweep.mask);

  const std::int64_t id = exam.next_sweep();
  exam.begin_sweep(id, setup);
  std::vector<exam::FrameRecord> batch;
  auto posed = sweep.frames.begin();
  for (int i = 0; i < s.frame_count(); ++i) {
    exam::FrameRecord r;
    r.pixels = {s.frame_pixels(i).data(), s.width, s.height, s.width};
    r.kind = setup.kind;
    r.number = i;
    const std::vector<std::int64_t> state = integers(s.frames[i].fields, "SonobandState");
    if (state.size() == 2) {
      r.pose_status = state[0] >= 0 && state[0] <= static_cast<int>(PoseStatus::new_epoch)
                          ? static_cast<PoseStatus>(state[0])
                          : PoseStatus::poor;
      r.pre_roll = state[1] != 0;
    }
    if (posed != sweep.frames.end() && posed->sequence == i) {
      r.pose_status = PoseStatus::ok;
      r.world_from_image = posed->world_from_image;
      r.captured = posed->captured;
      ++posed;
    } else {
      if (r.pose_status == PoseStatus::ok || state.empty()) r.pose_status = PoseStatus::poor;
      r.captured = Stamp(from_seconds(timestamp_s(s.frames[i]).value_or(0)));
    }
    const std::vector<std::int64_t> stamps = integers(s.frames[i].fields, "SonobandStampsNs");
    if (stamps.size() == 4) {
      r.captured = Stamp(Duration(stamps[0]));
      r.stamped = Stamp(Duration(stamps[1]));
      r.arrived = Stamp(Duration(stamps[2]));
      r.device_ns = stamps[3];
    } else {
      r.stamped = r.arrived = r.captured;
    }
    for (const FrameTransform& t : transforms_of(s.frames[i].fields, file)) {
      if (t.name != TransformName{"Probe", "Tracker"} || t.status != "OK") continue;
      r.tracker_from_probe.emplace();
      r.tracker_from_probe->rotation = t.to_from_from.topLeftCorner<3, 3>();
      r.tracker_from_probe->translation = t.to_from_from.topRightCorner<3, 1>();
    }
    const std::vector<std::int64_t> number = integers(s.frames[i].fields, "FrameNumber");
    if (number.size() == 1) r.device_count = static_cast<std::uint64_t>(number[0]);
    batch.push_back(r);
    if (batch.size() == 64 || i + 1 == s.frame_count()) {
      exam.append(id, batch, {});
      batch.clear();
    }
    step(progress, static_cast<std::size_t>(i) + 1, s.frames.size());
  }
  exam.end_sweep(id, s.frame_count(), {{"imported", static_cast<std::uint64_t>(s.frame_count())}});
  std::vector<std::string> said = std::move(sweep.warnings);
  for (const LeftOut& l : sweep.left_out)
    said.push_back(fmt::format("{}: {} frames have no place in space: {}", file, l.frames, l.cause));
  return said;
}

}  // namespace sonoband::exchange
