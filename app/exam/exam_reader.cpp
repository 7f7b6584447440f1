#include "app/exam/exam_reader.h"

#include <algorithm>
#include <map>

#include "app/exam/schema.h"
#include "app/exam/setup_json.h"

namespace sonoband::exam {
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
      p.time = Stamp(Duration(row.integer(1)));
      p.arrived = Stamp(Duration(row.integer(2)));
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

}  // namespace sonoband::exam
