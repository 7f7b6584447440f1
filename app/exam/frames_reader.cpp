// A sweep's frames out of an exam whose pages and rows may be damaged.
#include <algorithm>

#include "app/exam/exam_reader.h"
#include "app/exam/schema.h"

namespace sonoband::exam {
namespace {

constexpr std::int64_t most_frames = std::int64_t{1} << 32;  // of one sweep, by the numbering of rows
// Past a damaged place the next rows are looked for one by one; so many misses in a row are the end.
constexpr int misses_at_the_end = 256;

constexpr const char* frame_columns =
    "SELECT id, captured_ns, stamped_ns, arrived_ns, device_ns, device_count, pre_roll, pose_status, "
    "world_from_image, tracker_from_probe, width, height, kind, codec, pixels_checked, checked FROM frame ";

Stamp stamp(std::int64_t ns) {
  return Stamp(Duration(ns));
}

std::string frame_name(std::int64_t sweep, std::int64_t number) {
  return "sweep " + std::to_string(sweep) + ", frame " + std::to_string(number);
}

// False: the row is not what was written.
bool frame_from(const Statement& row, std::int64_t sweep, StoredFrame& out) {
  FrameRecord& f = out.record;
  const std::int64_t id = row.integer(0);
  f.number = id - frame_row(sweep, 0);
  f.captured = stamp(row.integer(1));
  f.stamped = stamp(row.integer(2));
  f.arrived = stamp(row.integer(3));
  f.device_ns = row.integer(4);
  f.device_count = static_cast<std::uint64_t>(row.integer(5));
  f.pre_roll = row.integer(6) != 0;
  const std::int64_t status = row.integer(7);
  const std::int64_t kind = row.integer(12);
  const std::int64_t codec = row.integer(13);
  if (status < 0 || status > static_cast<std::int64_t>(PoseStatus::new_epoch) || kind < 0 || kind > 1 ||
      codec < 0 || codec > 1) {
    return false;
  }
  f.pose_status = static_cast<PoseStatus>(status);
  if (f.pose_status == PoseStatus::ok &&
      !matrix_from(row.blob(8), f.world_from_image.linear, f.world_from_image.translation)) {
    return false;
  }
  if (!row.is_null(9)) {
    f.tracker_from_probe.emplace();
    if (!matrix_from(row.blob(9), f.tracker_from_probe->rotation, f.tracker_from_probe->translation))
      return false;
  }
  const std::int64_t width = row.integer(10);
  const std::int64_t height = row.integer(11);
  if (width < 0 || width > longest_side_px || height < 0 || height > longest_side_px) return false;
  f.pixels.width = static_cast<int>(width);
  f.pixels.height = static_cast<int>(height);
  f.pixels.stride = width;
  f.kind = static_cast<PixelKind>(kind);
  out.codec = static_cast<Codec>(codec);
  out.pixels_checked = row.integer(14);
  return row.integer(15) == row_checksum(id, f, out.codec, out.pixels_checked);
}

// Numbers of frames from `first` to `last`, both included.
struct Run {
  std::int64_t first = 0;
  std::int64_t last = 0;
};

std::string name_run(std::int64_t sweep, const Run& run) {
  const std::string what = ": the record is damaged or missing";
  if (run.first == run.last) return frame_name(sweep, run.first) + what;
  return "sweep " + std::to_string(sweep) + ", frames " + std::to_string(run.first) + " to " +
         std::to_string(run.last) + what;
}

}  // namespace

std::int64_t ExamReader::count_frames(std::int64_t sweep) const {
  Statement count = database_.prepare("SELECT count(*) FROM frame WHERE id BETWEEN ?1 AND ?2");
  count.bind(1, frame_row(sweep, 0)).bind(2, frame_row(sweep + 1, 0) - 1);
  return count.step() ? count.integer(0) : 0;
}

StoredFrames ExamReader::frames(std::int64_t sweep) const {
  const SweepSetup made = setup(sweep);
  StoredFrames out;
  std::vector<Run> damaged;
  std::int64_t next = 0;      // the first number not accounted for yet
  std::int64_t bad_rows = 0;  // not even their numbers can be trusted
  const auto take = [&](const Statement& row) {
    const std::int64_t number = row.integer(0) - frame_row(sweep, 0);
    StoredFrame frame;
    const bool whole = frame_from(row, sweep, frame) && frame.record.pixels.width == made.width &&
                       frame.record.pixels.height == made.height && frame.record.kind == made.kind &&
                       number >= next;
    if (!whole) {
      ++bad_rows;
      return;
    }
    if (number > next) damaged.push_back({next, number - 1});
    out.frames.push_back(std::move(frame));
    next = number + 1;
  };
  // How many there should be: said at the sweep's end, where it had one.
  std::int64_t expected = -1;
  try {
    for (const SweepSummary& s : sweeps())
      if (s.id == sweep && s.ended) expected = s.frames;
  } catch (const StoreError& e) {
    out.damage.push_back(e.what());
  }
  try {
    Statement row = database_.prepare(std::string(frame_columns) + "WHERE id BETWEEN ?1 AND ?2 ORDER BY id");
    row.bind(1, frame_row(sweep, 0))
        .bind(2, frame_row(sweep, 0) + (expected < 0 ? most_frames : expected) - 1);
    while (row.step()) take(row);
  } catch (const StoreError& e) {
    if (e.kind() != StoreError::Kind::damaged) throw;
    // A page of the table is damaged: walk around it.
    Statement row = database_.prepare(std::string(frame_columns) + "WHERE id = ?1");
    std::int64_t number = next;
    for (int misses = 0; expected >= 0 ? number < expected : misses < misses_at_the_end; ++number) {
      const std::int64_t before = next;
      try {
        row.reset();
        if (row.bind(1, frame_row(sweep, number)).step()) take(row);
      } catch (const StoreError& again) {
        if (again.kind() != StoreError::Kind::damaged) throw;
      }
      misses = next > before ? 0 : misses + 1;
    }
    if (expected < 0)
      out.damage.push_back("sweep " + std::to_string(sweep) +
                           ": the table of frames is damaged; frames after number " +
                           std::to_string(next - 1) + " may be missing");
  }
  if (next < expected) damaged.push_back({next, expected - 1});
  for (const Run& run : damaged) out.damage.push_back(name_run(sweep, run));
  if (damaged.empty() && bad_rows > 0)
    out.damage.push_back("sweep " + std::to_string(sweep) + ": " + std::to_string(bad_rows) +
                         " records of frames are damaged");
  return out;
}

std::string ExamReader::pixels(std::int64_t sweep, const StoredFrame& frame,
                               ImageView<std::uint8_t> out) const {
  const std::int64_t number = frame.record.number;
  const std::int64_t id = frame_row(sweep, number);
  try {
    if (!prepared_) {
      pixels_ = database_.prepare("SELECT bytes FROM pixels WHERE id = ?1");
      prepared_ = true;
    }
    pixels_.reset();
    if (!pixels_.bind(1, id).step()) return frame_name(sweep, number) + ": the picture is missing";
    const std::span<const std::uint8_t> bytes = pixels_.blob(0);
    const bool whole = checksum(bytes, static_cast<std::uint64_t>(id)) == frame.pixels_checked &&
                       unpack(frame.codec, bytes, out);
    pixels_.reset();
    return whole ? std::string() : frame_name(sweep, number) + ": the picture is damaged";
  } catch (const StoreError& e) {
    pixels_.reset();
    if (e.kind() != StoreError::Kind::damaged) throw;
    return frame_name(sweep, number) + ": the picture cannot be read";
  }
}

}  // namespace sonoband::exam
