#include "app/exam/exam_reader.h"

#include <algorithm>
#include <map>

#include "app/exam/schema.h"
#include "app/exam/setup_json.h"

namespace sonoband::exam {
namespace {

constexpr int longest_side_px = 16384;
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

ExamReader::ExamReader(const std::filesystem::path& file, const std::string& vfs) : file_(file) {
  if (!std::filesystem::exists(file))
    throw StoreError(StoreError::Kind::refused, file.filename().string() + ": there is no such exam");
  database_ = Database(file, Database::Mode::read, vfs);
  if (!up_to_date(database_, migrations())) {
    // An older schema is brought up to date where it lies, by the writer's one way of doing it.
    database_ = {};
    Database writer(file, Database::Mode::write, vfs);
    migrate(writer, migrations());
    database_ = Database(file, Database::Mode::read, vfs);
  }
}

ExamSummary ExamReader::summary() const {
  ExamSummary s;
  s.path = file_.string();
  Statement exam = database_.prepare("SELECT id, created_utc_ns, software, checked FROM exam");
  if (!exam.step() || exam.integer(3) != text_checksum(exam.integer(1), exam.text(0) + '\n' + exam.text(2))) {
    throw StoreError(StoreError::Kind::damaged, file_.filename().string() + ": its head is damaged");
  }
  s.id = exam.text(0);
  s.created_utc_ns = exam.integer(1);
  exam.reset();
  Statement label =
      database_.prepare("SELECT label, written_utc_ns, checked FROM label ORDER BY id DESC LIMIT 1");
  if (label.step()) {
    s.label = label.text(0);
    if (label.integer(2) != text_checksum(label.integer(1), s.label))
      throw StoreError(StoreError::Kind::damaged, file_.filename().string() + ": its label is damaged");
  }
  s.sweeps = database_.integer("SELECT count(*) FROM sweep");
  for (const SweepSummary& sweep : sweeps()) s.frames += sweep.frames;
  s.closed = database_.text("SELECT what FROM event ORDER BY id DESC LIMIT 1") == "closed";
  std::error_code none;
  s.bytes = static_cast<std::int64_t>(std::filesystem::file_size(file_, none));
  return s;
}

std::vector<SweepSummary> ExamReader::sweeps() const {
  std::vector<SweepSummary> all;
  Statement row = database_.prepare(
      "SELECT sweep.id, frames, interrupted, ledger_json, sweep_end.checked, poses FROM sweep LEFT JOIN "
      "sweep_end ON sweep = sweep.id ORDER BY sweep.id");
  while (row.step()) {
    SweepSummary s;
    s.id = row.integer(0);
    if (row.is_null(1)) {
      s.frames = count_frames(s.id);
    } else {
      s.ended = true;
      s.frames = row.integer(1);
      s.interrupted = row.integer(2) != 0;
      const std::string ledger = row.text(3);
      if (row.integer(4) != end_checksum(s.id, s.frames, row.integer(5), s.interrupted, ledger))
        throw StoreError(StoreError::Kind::damaged, file_.filename().string() + ": the end of sweep " +
                                                        std::to_string(s.id) + " is damaged");
      try {
        s.ledger = counters_from_json(ledger);
      } catch (const std::exception& e) {
        throw StoreError(StoreError::Kind::damaged, file_.filename().string() + ": the ledger of sweep " +
                                                        std::to_string(s.id) +
                                                        " cannot be understood: " + e.what());
      }
    }
    all.push_back(std::move(s));
  }
  return all;
}

SweepSetup ExamReader::setup(std::int64_t sweep) const {
  const std::string name = file_.filename().string() + ", sweep " + std::to_string(sweep);
  Statement row = database_.prepare("SELECT setup_json, mask, checked FROM sweep WHERE id = ?1");
  if (!row.bind(1, sweep).step())
    throw StoreError(StoreError::Kind::refused, name + ": there is no such sweep");
  const std::string json = row.text(0);
  const std::span<const std::uint8_t> mask = row.blob(1);
  if (row.integer(2) != (text_checksum(sweep, json) ^ checksum(mask, static_cast<std::uint64_t>(sweep))))
    throw StoreError(StoreError::Kind::damaged, name + ": its calibration and settings are damaged");
  SweepSetup setup;
  try {
    setup = setup_from_json(json);
  } catch (const std::exception& e) {
    throw StoreError(StoreError::Kind::damaged, name + ": its settings cannot be understood: " + e.what());
  }
  if (setup.width < 0 || setup.height < 0 || setup.width > longest_side_px || setup.height > longest_side_px)
    throw StoreError(StoreError::Kind::damaged, name + ": its pictures have an impossible size");
  if (!mask.empty()) {
    if (mask.size() != static_cast<std::size_t>(setup.width) * setup.height)
      throw StoreError(StoreError::Kind::damaged, name + ": its mask does not have the pictures' size");
    setup.mask = Pixels(setup.width, setup.height);
    std::copy(mask.begin(), mask.end(), setup.mask.view().data);
  }
  return setup;
}

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

std::vector<PoseSample> ExamReader::poses(std::int64_t sweep, std::vector<std::string>& damage) const {
  std::vector<PoseSample> all;
  std::int64_t bad = 0;
  std::int64_t rows = 0;
  try {
    Statement row = database_.prepare(
        "SELECT id, time_ns, arrived_ns, quality, epoch, device_frame, device_ms, tracker_from_probe, "
        "checked "
        "FROM pose WHERE id BETWEEN ?1 AND ?2 ORDER BY id");
    row.bind(1, frame_row(sweep, 0)).bind(2, frame_row(sweep + 1, 0) - 1);
    while (row.step()) {
      ++rows;
      PoseSample p;
      p.time = stamp(row.integer(1));
      p.arrived = stamp(row.integer(2));
      const std::int64_t quality = row.integer(3);
      p.epoch = static_cast<std::uint32_t>(row.integer(4));
      p.device_frame = static_cast<std::uint32_t>(row.integer(5));
      p.device_ms = static_cast<std::uint32_t>(row.integer(6));
      bool whole = quality >= 0 && quality <= static_cast<std::int64_t>(PoseQuality::missing) &&
                   matrix_from(row.blob(7), p.tracker_from_probe.rotation, p.tracker_from_probe.translation);
      if (whole) {
        p.quality = static_cast<PoseQuality>(quality);
        whole = row.integer(8) == row_checksum(row.integer(0), p);
      }
      if (whole) {
        all.push_back(p);
      } else {
        ++bad;
      }
    }
    Statement end = database_.prepare("SELECT poses FROM sweep_end WHERE sweep = ?1");
    if (end.bind(1, sweep).step() && end.integer(0) > rows) bad += end.integer(0) - rows;
  } catch (const StoreError& e) {
    if (e.kind() != StoreError::Kind::damaged) throw;
    damage.push_back("sweep " + std::to_string(sweep) + ": raw readings of the tracker after number " +
                     std::to_string(rows) + " cannot be read");
  }
  if (bad > 0)
    damage.push_back("sweep " + std::to_string(sweep) + ": " + std::to_string(bad) +
                     " raw readings of the tracker are damaged or missing");
  return all;
}

std::vector<ReviewObject> ExamReader::review(std::vector<std::string>& damage, bool all) const {
  std::vector<ReviewObject> objects;
  std::map<std::string, std::size_t> newest;
  try {
    Statement row = database_.prepare(
        "SELECT id, object, kind, version, removed, written_utc_ns, json, png, checked FROM review ORDER BY "
        "id");
    while (row.step()) {
      ReviewObject o;
      o.object = row.text(1);
      const std::optional<ReviewKind> kind = review_kind(row.text(2));
      o.version = row.integer(3);
      o.removed = row.integer(4) != 0;
      o.written_utc_ns = row.integer(5);
      o.json = row.text(6);
      const std::span<const std::uint8_t> png = row.blob(7);
      o.png.assign(png.begin(), png.end());
      if (kind) o.kind = *kind;
      if (!kind || row.integer(8) != row_checksum(row.integer(0), o)) {
        damage.push_back("review object " + o.object + ", version " + std::to_string(o.version) +
                         ": damaged");
        continue;
      }
      const auto [at, is_new] = newest.try_emplace(o.object, objects.size());
      if (is_new || all) {
        at->second = objects.size();
        objects.push_back(std::move(o));
      } else {
        objects[at->second] = std::move(o);
      }
    }
  } catch (const StoreError& e) {
    if (e.kind() != StoreError::Kind::damaged) throw;
    damage.push_back("review objects after number " + std::to_string(objects.size()) + " cannot be read");
  }
  if (!all) std::erase_if(objects, [](const ReviewObject& o) { return o.removed; });
  return objects;
}

ExamReader::Verification ExamReader::verify(const std::function<bool(int)>& progress) const {
  Verification v;
  const auto guarded = [&](const std::string& place, const auto& work) {
    try {
      work();
    } catch (const StoreError& e) {
      // Whoever reads this knows which exam it is.
      std::string what = e.what();
      const std::string name = file_.filename().string() + ": ";
      if (what.starts_with(name)) what.erase(0, name.size());
      v.damage.push_back(place + what);
    }
  };
  std::vector<SweepSummary> all;
  guarded("", [&] { all = sweeps(); });
  if (all.empty()) {
    // The list is damaged: the sweeps themselves may still be there.
    guarded("", [&] {
      Statement row = database_.prepare("SELECT id FROM sweep ORDER BY id");
      while (row.step()) all.emplace_back().id = row.integer(0);
    });
  }
  v.sweeps = static_cast<std::int64_t>(all.size());
  std::int64_t expected = 1;
  for (const SweepSummary& s : all) expected += s.frames;
  std::int64_t seen = 0;
  bool stopped = false;
  for (const SweepSummary& s : all) {
    guarded("sweep " + std::to_string(s.id) + ": ", [&] {
      const SweepSetup made = setup(s.id);
      StoredFrames found = frames(s.id);
      v.damage.insert(v.damage.end(), found.damage.begin(), found.damage.end());
      Pixels picture(made.width, made.height);
      for (const StoredFrame& f : found.frames) {
        const std::string wrong = pixels(s.id, f, picture.view());
        if (!wrong.empty()) v.damage.push_back(wrong);
        ++v.frames;
        if (++seen % 64 == 0 && progress &&
            !progress(static_cast<int>(seen * 1000 / std::max(expected, seen)))) {
          stopped = true;
          return;
        }
      }
      v.poses += static_cast<std::int64_t>(poses(s.id, v.damage).size());
    });
    if (stopped) return v;
  }
  guarded("", [&] {
    static_cast<void>(summary());
    Statement row = database_.prepare("SELECT id, utc_ns, what, detail, checked FROM event");
    while (row.step())
      if (row.integer(4) != text_checksum(row.integer(1), row.text(2) + '\n' + row.text(3)))
        v.damage.push_back("event " + std::to_string(row.integer(0)) + ": damaged");
  });
  guarded("", [&] { v.reviews = static_cast<std::int64_t>(review(v.damage, true).size()); });
  guarded("", [&] {
    Statement row = database_.prepare("PRAGMA integrity_check(20)");
    while (row.step())
      if (row.text(0) != "ok") v.damage.push_back("structure of the file: " + row.text(0));
  });
  if (progress) progress(1000);
  return v;
}

}  // namespace sonoband::exam
