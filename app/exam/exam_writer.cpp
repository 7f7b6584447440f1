#include "app/exam/exam_writer.h"

#include <fcntl.h>
#include <unistd.h>

#include <cassert>
#include <chrono>
#include <system_error>

#include "app/exam/schema.h"
#include "app/exam/setup_json.h"

namespace sonoband::exam {
namespace {

std::int64_t ns(Stamp t) {
  return t.time_since_epoch().count();
}

std::int64_t setup_checksum(std::int64_t sweep, const std::string& json, std::span<const std::uint8_t> mask) {
  return text_checksum(sweep, json) ^ checksum(mask, static_cast<std::uint64_t>(sweep));
}

}  // namespace

std::int64_t utc_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

ExamWriter ExamWriter::create(const std::filesystem::path& file, const std::string& id,
                              const std::string& vfs) {
  if (std::filesystem::exists(file))
    throw StoreError(StoreError::Kind::refused, file.filename().string() + ": there is such an exam already");
  std::filesystem::path making = file;
  making += ".new";
  std::error_code error;
  // An attempt that failed, on a full disk say, has left it.
  for (const char* end : {"", "-journal"}) std::filesystem::remove(making.string() + end, error);
  {
    Database database(making, Database::Mode::create, vfs);
    database.run("PRAGMA page_size=16384");
    database.run("PRAGMA synchronous=FULL");
    migrate(database, migrations());
    Transaction transaction(database);
    Statement add = database.prepare("INSERT INTO exam VALUES(?1, ?2, ?3, ?4)");
    const std::string software = "sonoband " SONOBAND_VERSION;
    const std::int64_t now = utc_now_ns();
    add.bind(1, id).bind(2, now).bind(3, software).bind(4, text_checksum(now, id + '\n' + software)).run();
    transaction.commit();
  }
  std::filesystem::rename(making, file, error);
  if (error)
    throw StoreError(StoreError::Kind::failing, making.string() + ": cannot be renamed: " + error.message());
  const int folder = ::open(file.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return open(file, vfs);
}

ExamWriter ExamWriter::open(const std::filesystem::path& file, const std::string& vfs) {
  return {file, Database::Mode::write, vfs};
}

ExamWriter::ExamWriter(const std::filesystem::path& file, Database::Mode mode, const std::string& vfs)
    : database_(file, mode, vfs) {
  // The writer says when the journal is copied into the file: see Recorder. A commit never does it.
  database_.run("PRAGMA synchronous=FULL; PRAGMA wal_autocheckpoint=0");
  if (database_.text("PRAGMA journal_mode=WAL") != "wal")
    throw StoreError(StoreError::Kind::refused,
                     file.filename().string() + ": its disk cannot keep a journal (WAL)");
  migrate(database_, migrations());
  prepare();
}

void ExamWriter::prepare() {
  add_frame_ = database_.prepare(
      "INSERT INTO frame VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16)");
  add_pixels_ = database_.prepare("INSERT INTO pixels VALUES(?1, ?2)");
  add_pose_ = database_.prepare("INSERT INTO pose VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)");
}

std::int64_t ExamWriter::next_sweep() const {
  return database_.integer("SELECT coalesce(max(id), 0) + 1 FROM sweep");
}

void ExamWriter::begin_sweep(std::int64_t sweep, const SweepSetup& setup) {
  Transaction transaction(database_);
  Statement there = database_.prepare("SELECT 1 FROM sweep WHERE id = ?1");
  if (there.bind(1, sweep).step()) return;
  const std::string json = to_json(setup);
  const ConstPixels mask = setup.mask.view();
  const std::span<const std::uint8_t> mask_bytes{mask.data,
                                                 static_cast<std::size_t>(mask.width) * mask.height};
  Statement add = database_.prepare("INSERT INTO sweep VALUES(?1, ?2, ?3, ?4)");
  add.bind(1, sweep).bind(2, std::string_view(json)).bind(4, setup_checksum(sweep, json, mask_bytes));
  if (mask_bytes.empty()) {
    add.bind_null(3);
  } else {
    add.bind(3, mask_bytes);
  }
  add.run();
  transaction.commit();
}

std::int64_t ExamWriter::stored_frames(std::int64_t sweep) const {
  Statement last = database_.prepare("SELECT max(id) FROM frame WHERE id BETWEEN ?1 AND ?2");
  last.bind(1, frame_row(sweep, 0)).bind(2, frame_row(sweep + 1, 0) - 1);
  return last.step() && !last.is_null(0) ? last.integer(0) - frame_row(sweep, 0) + 1 : 0;
}

std::int64_t ExamWriter::stored_poses(std::int64_t sweep) const {
  Statement last = database_.prepare("SELECT max(id) FROM pose WHERE id BETWEEN ?1 AND ?2");
  last.bind(1, frame_row(sweep, 0)).bind(2, frame_row(sweep + 1, 0) - 1);
  return last.step() && !last.is_null(0) ? last.integer(0) - frame_row(sweep, 0) + 1 : 0;
}

void ExamWriter::append(std::int64_t sweep, std::span<const FrameRecord> frames,
                        std::span<const PoseSample> poses) {
  if (frames.empty() && poses.empty()) return;
  Transaction transaction(database_);
  assert(frames.empty() || frames.front().number == stored_frames(sweep));
  for (const FrameRecord& f : frames) {
    const std::int64_t id = frame_row(sweep, f.number);
    pack(f.pixels, packed_, scratch_);
    const std::int64_t pixels_checked = checksum(packed_.bytes, static_cast<std::uint64_t>(id));
    std::vector<std::uint8_t> world;
    std::vector<std::uint8_t> probe;
    add_frame_.bind(1, id).bind(2, ns(f.captured)).bind(3, ns(f.stamped)).bind(4, ns(f.arrived));
    add_frame_.bind(5, f.device_ns).bind(6, static_cast<std::int64_t>(f.device_count));
    add_frame_.bind(7, static_cast<std::int64_t>(f.pre_roll))
        .bind(8, static_cast<std::int64_t>(f.pose_status));
    if (f.pose_status == PoseStatus::ok) {
      world = matrix_bytes(f.world_from_image.linear, f.world_from_image.translation);
      add_frame_.bind(9, std::span<const std::uint8_t>(world));
    } else {
      add_frame_.bind_null(9);
    }
    if (f.tracker_from_probe) {
      probe = matrix_bytes(f.tracker_from_probe->rotation, f.tracker_from_probe->translation);
      add_frame_.bind(10, std::span<const std::uint8_t>(probe));
    } else {
      add_frame_.bind_null(10);
    }
    add_frame_.bind(11, std::int64_t{f.pixels.width}).bind(12, std::int64_t{f.pixels.height});
    add_frame_.bind(13, static_cast<std::int64_t>(f.kind)).bind(14, static_cast<std::int64_t>(packed_.codec));
    add_frame_.bind(15, pixels_checked).bind(16, row_checksum(id, f, packed_.codec, pixels_checked));
    add_frame_.run();
    add_pixels_.bind(1, id).bind(2, std::span<const std::uint8_t>(packed_.bytes)).run();
  }
  std::int64_t pose_id = poses.empty() ? 0 : frame_row(sweep, stored_poses(sweep));
  for (const PoseSample& p : poses) {
    const std::vector<std::uint8_t> matrix =
        matrix_bytes(p.tracker_from_probe.rotation, p.tracker_from_probe.translation);
    add_pose_.bind(1, pose_id).bind(2, ns(p.time)).bind(3, ns(p.arrived));
    add_pose_.bind(4, static_cast<std::int64_t>(p.quality)).bind(5, std::int64_t{p.epoch});
    add_pose_.bind(6, std::int64_t{p.device_frame}).bind(7, std::int64_t{p.device_ms});
    add_pose_.bind(8, std::span<const std::uint8_t>(matrix)).bind(9, row_checksum(pose_id, p)).run();
    ++pose_id;
  }
  transaction.commit();
}

void ExamWriter::end_sweep(std::int64_t sweep, std::int64_t frames, const std::vector<Counter>& ledger,
                           bool interrupted) {
  Transaction transaction(database_);
  Statement there = database_.prepare("SELECT 1 FROM sweep_end WHERE sweep = ?1");
  if (there.bind(1, sweep).step()) return;
  const std::string json = to_json(ledger);
  assert(frames <= stored_frames(sweep));
  const std::int64_t poses = stored_poses(sweep);
  Statement add = database_.prepare("INSERT INTO sweep_end VALUES(?1, ?2, ?3, ?4, ?5, ?6)");
  add.bind(1, sweep)
      .bind(2, frames)
      .bind(3, poses)
      .bind(4, std::int64_t{interrupted})
      .bind(5, std::string_view(json));
  add.bind(6, end_checksum(sweep, frames, poses, interrupted, json)).run();
  transaction.commit();
}

std::vector<std::int64_t> ExamWriter::sweeps_without_end() const {
  std::vector<std::int64_t> open;
  Statement s =
      database_.prepare("SELECT id FROM sweep WHERE id NOT IN (SELECT sweep FROM sweep_end) ORDER BY id");
  while (s.step()) open.push_back(s.integer(0));
  return open;
}

std::int64_t ExamWriter::add_review(const ReviewObject& o) {
  Transaction transaction(database_);
  Statement last = database_.prepare("SELECT coalesce(max(version), 0) FROM review WHERE object = ?1");
  const std::int64_t version = last.bind(1, std::string_view(o.object)).step() ? last.integer(0) + 1 : 1;
  last.reset();
  const std::int64_t id = database_.integer("SELECT coalesce(max(id), 0) + 1 FROM review");
  Statement add = database_.prepare("INSERT INTO review VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)");
  add.bind(1, id)
      .bind(2, std::string_view(o.object))
      .bind(3, std::string_view(name_of(o.kind)))
      .bind(4, version);
  add.bind(5, std::int64_t{o.removed}).bind(6, o.written_utc_ns).bind(7, std::string_view(o.json));
  if (o.png.empty()) {
    add.bind_null(8);
  } else {
    add.bind(8, std::span<const std::uint8_t>(o.png));
  }
  ReviewObject versioned = o;
  versioned.version = version;
  add.bind(9, row_checksum(id, versioned)).run();
  transaction.commit();
  return version;
}

void ExamWriter::set_label(const std::string& label) {
  Transaction transaction(database_);
  Statement add = database_.prepare("INSERT INTO label(written_utc_ns, label, checked) VALUES(?1, ?2, ?3)");
  const std::int64_t now = utc_now_ns();
  add.bind(1, now).bind(2, std::string_view(label)).bind(3, text_checksum(now, label)).run();
  transaction.commit();
}

void ExamWriter::add_event(const std::string& what, const std::string& detail) {
  Transaction transaction(database_);
  Statement add =
      database_.prepare("INSERT INTO event(utc_ns, what, detail, checked) VALUES(?1, ?2, ?3, ?4)");
  const std::int64_t now = utc_now_ns();
  add.bind(1, now).bind(2, std::string_view(what)).bind(3, std::string_view(detail));
  add.bind(4, text_checksum(now, what + '\n' + detail)).run();
  transaction.commit();
}

void ExamWriter::close() {
  if (!database_) return;
  add_event("closed", "");
  database_.checkpoint(true);
  add_frame_ = {};
  add_pixels_ = {};
  add_pose_ = {};
  database_ = {};
}

}  // namespace sonoband::exam
