#include "app/exchange/sweep_from_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/bad_input.h"
#include "app/exchange/doppler_pixels.h"
#include "app/exchange/grey_pixels.h"
#include "core/image/overlay.h"
#include "core/sweep/drawings.h"

namespace sonoband::exchange {

namespace {

// Stamps of all frames where they can order them; empty otherwise.
std::vector<double> ordering_stamps(const TrackedSequence& s, const std::string& file,
                                    std::vector<std::string>& warnings) {
  std::vector<double> stamps;
  for (const SequenceFrame& frame : s.frames) {
    const auto t = timestamp_s(frame);
    if (!t || (!stamps.empty() && *t < stamps.back()) || std::abs(*t) > 1e9 * 5) {
      warnings.push_back(fmt::format("{}: frame {} has {}; the frames are taken in the order of the file.",
                                     file, stamps.size(),
                                     t ? "an earlier time stamp than the frame before" : "no time stamp"));
      return {};
    }
    stamps.push_back(*t);
  }
  return stamps;
}

void count(std::vector<LeftOut>& left_out, const std::string& cause) {
  auto found =
      std::find_if(left_out.begin(), left_out.end(), [&](const LeftOut& l) { return l.cause == cause; });
  if (found == left_out.end()) found = left_out.insert(left_out.end(), {cause, 0});
  ++found->frames;
}

void check_pictures(const TrackedSequence& s, const std::string& file) {
  const auto refuse = [&](const std::string& why) { throw BadInput(fmt::format("{}: {}", file, why)); };
  if (!s.has_pictures())
    refuse("it holds tracker readings and no pictures; name the recording of the pictures.");
  if (s.slices > 1) refuse("its frames are volumes; only 2-D pictures are rendered.");
  if (s.image_type.starts_with("RF_"))
    refuse(
        fmt::format("its pictures are raw echoes ({}); make B-mode pictures of them first.", s.image_type));
  if (s.orientation != "MFA")
    refuse(fmt::format("its pictures lie as {}, with scan lines as rows; make B-mode pictures of them first.",
                       s.orientation));
}

std::vector<std::string> reachable(const TransformGraph& graph) {
  std::vector<std::string> names;
  for (const std::string& frame : graph.frames()) {
    if (counts_pixels(frame)) continue;
    try {
      if (graph.find(frame, "Image")) names.push_back(frame);
    } catch (const BadInput&) {
      names.push_back(frame);  // there is a way, though a bad one
    }
  }
  return names;
}

[[noreturn]] void refuse_unreachable(const TransformGraph& graph, const std::string& world,
                                     const std::string& file) {
  const auto ways = reachable(graph);
  if (world.empty())
    throw BadInput(fmt::format("{}: it has neither Reference nor Tracker; choose --world among {}.", file,
                               listed(ways.empty() ? graph.frames() : ways)));
  if (ways.empty())
    throw BadInput(
        fmt::format("{}: no transform leads away from Image (there are {}); give --calibration with a "
                    "Transform From=\"Image\".",
                    file, listed(graph.frames())));
  throw BadInput(fmt::format("{}: no chain of transforms leads from Image to {}; choose --world among {}.",
                             file, world, listed(ways)));
}

bool moved(const SequenceSweep& sweep) {
  std::vector<const TrackedFrame*> all;
  for (const TrackedFrame& f : sweep.frames) all.push_back(&f);
  return probe_moved(all, sweep.sequence.width, sweep.sequence.height);
}

// The sequence's pixels to one byte each, and the sweep's kind and mask.
void make_bytes(SequenceSweep& sweep, const PlusConfig& config, const SweepRequest& request,
                const std::string& file) {
  TrackedSequence& s = sweep.sequence;
  if (request.mask) sweep.mask = sector_mask(s.width, s.height, config.clip, request.clip, config.fan, file);
  const bool rgb = s.components == 3 && s.element_type == ElementType::uint8;
  if (rgb && request.colour != ColourUse::grey) {
    const doppler::ColourClassifier classifier(request.bar, {});
    if (request.colour == ColourUse::doppler || shows_flow(s, sweep.mask.view(), classifier)) {
      Pixels ultrasound = make_doppler(s, sweep.mask.view(), classifier, moved(sweep));
      if (request.mask) sweep.mask = std::move(ultrasound);
      sweep.kind = PixelKind::doppler;
      return;
    }
  }
  make_grey(s, file, sweep.warnings);
}

}  // namespace

TransformGraph shared_transforms(const TrackedSequence& sequence, const PlusConfig* config,
                                 const std::string& file) {
  TransformGraph graph;
  if (config != nullptr) graph.add(config->transforms);
  for (const FrameTransform& t : transforms_of(sequence.fields, file + ", header"))
    if (t.ok()) graph.add(t.name, t.to_from_from, file + ", header");
  return graph;
}

std::string default_world(const TrackedSequence& sequence) {
  bool tracker = false;
  bool reference = false;
  const auto look = [&](const std::vector<Field>& fields) {
    for (const Field& field : fields)
      if (const auto name = transform_name(field.name)) {
        reference = reference || name->from == "Reference" || name->to == "Reference";
        tracker = tracker || name->from == "Tracker" || name->to == "Tracker";
      }
  };
  look(sequence.fields);
  for (const SequenceFrame& frame : sequence.frames) look(frame.fields);
  return reference ? "Reference" : tracker ? "Tracker" : "";
}

SequenceSweep sweep_from_sequence(ReadSequence&& read, const PlusConfig& config, const SweepRequest& request,
                                  const std::string& file) {
  SequenceSweep sweep;
  sweep.sequence = std::move(read.sequence);
  sweep.warnings = std::move(read.warnings);
  sweep.warnings.insert(sweep.warnings.end(), config.warnings.begin(), config.warnings.end());
  TrackedSequence& s = sweep.sequence;
  check_pictures(s, file);

  const auto [first, last] = request.frames.value_or(std::pair(0, s.frame_count() - 1));
  if (first < 0 || last < first || last >= s.frame_count())
    throw BadInput(fmt::format("{}: frames {} to {} were asked for and it has 0 to {}; choose among them.",
                               file, first, last, s.frame_count() - 1));

  const TransformGraph shared = shared_transforms(s, &config, file);
  std::vector<FrameTransform> transforms;
  const auto graph_of = [&](int i) {
    const std::string place = fmt::format("{}, frame {}", file, i);
    transforms = transforms_of(s.frames[i].fields, place);
    return shared.with(transforms, place);
  };
  // For sentences: what there is where a frame has transforms at all.
  TransformGraph example = shared;
  for (int i = 0; i < s.frame_count(); ++i) {
    example = graph_of(i);
    if (!transforms.empty()) break;
  }
  sweep.world = request.world.empty() ? default_world(s) : request.world;
  if (sweep.world.empty() && transforms.empty())
    throw BadInput(
        fmt::format("{}: there is no transform beside any of its pictures; name a tracked recording.", file));
  if (sweep.world.empty()) refuse_unreachable(example, sweep.world, file);

  const std::vector<double> stamps = ordering_stamps(s, file, sweep.warnings);
  sweep.frames.reserve(static_cast<std::size_t>(last - first) + 1);
  int unreachable = 0;
  int no_status = 0;
  for (int i = first; i <= last; ++i) {
    if (!image_ok(s.frames[i])) {
      count(sweep.left_out, "ImageStatus is not OK");
      continue;
    }
    const TransformGraph graph = graph_of(i);
    const auto found = graph.find(sweep.world, "Image");
    if (!found) {
      ++unreachable;
      count(sweep.left_out, "no transforms from Image to " + sweep.world);
      continue;
    }
    if (!found->ok) {
      count(sweep.left_out, found->bad_link);
      continue;
    }
    no_status += std::any_of(transforms.begin(), transforms.end(), [&](const FrameTransform& t) {
      const std::string name = t.name.from + "To" + t.name.to;
      return t.status.empty() &&
             (std::find(found->links.begin(), found->links.end(), name) != found->links.end() ||
              std::find(found->links.begin(), found->links.end(), "inverse of " + name) !=
                  found->links.end());
    });
    if (sweep.links.empty()) sweep.links = found->links;
    TrackedFrame frame;
    frame.sequence = i;
    if (!stamps.empty()) frame.captured = Stamp(from_seconds(stamps[i]));
    set_pose(frame, {found->to_from_from.topLeftCorner<3, 3>(), found->to_from_from.topRightCorner<3, 1>()});
    sweep.frames.push_back(frame);
  }
  if (unreachable == last - first + 1) refuse_unreachable(example, sweep.world, file);
  if (sweep.frames.empty()) {
    std::vector<std::string> causes;
    for (const LeftOut& l : sweep.left_out)
      causes.push_back(fmt::format("{} ({} frames)", l.cause, l.frames));
    throw BadInput(
        fmt::format("{}: no frame of {} to {} has a usable pose: {}; choose other frames or track again.",
                    file, first, last, listed(causes)));
  }
  if (no_status > 0)
    sweep.warnings.push_back(
        fmt::format("{}: {} frames have a transform without a status; it is taken as OK.", file, no_status));
  make_bytes(sweep, config, request, file);
  for (TrackedFrame& frame : sweep.frames) {
    frame.bscan.pixels = {s.frame_pixels(static_cast<int>(frame.sequence)).data(), s.width, s.height,
                          s.width};
    frame.bscan.kind = sweep.kind;
    sweep.frame_pointers.push_back(&frame);
  }
  return sweep;
}

}  // namespace sonoband::exchange
