#include "app/exam/schema.h"

#include <array>

namespace sonoband::exam {
namespace {

// Text columns that end in `json` hold one JSON object. `checked` is XXH3 over the row (frame_codec.h).
const char* const first_schema = R"sql(
CREATE TABLE exam(
  id TEXT NOT NULL, created_utc_ns INTEGER NOT NULL, software TEXT NOT NULL,
  checked INTEGER NOT NULL);
CREATE TABLE label(id INTEGER PRIMARY KEY, written_utc_ns INTEGER NOT NULL, label TEXT NOT NULL,
  checked INTEGER NOT NULL);
CREATE TABLE event(id INTEGER PRIMARY KEY, utc_ns INTEGER NOT NULL, what TEXT NOT NULL, detail TEXT NOT NULL,
  checked INTEGER NOT NULL);
CREATE TABLE sweep(
  id INTEGER PRIMARY KEY, setup_json TEXT NOT NULL, mask BLOB, checked INTEGER NOT NULL);
CREATE TABLE sweep_end(
  sweep INTEGER PRIMARY KEY REFERENCES sweep(id), frames INTEGER NOT NULL, poses INTEGER NOT NULL,
  interrupted INTEGER NOT NULL, ledger_json TEXT NOT NULL, checked INTEGER NOT NULL);
CREATE TABLE frame(
  id INTEGER PRIMARY KEY, captured_ns INTEGER NOT NULL, stamped_ns INTEGER NOT NULL, arrived_ns INTEGER NOT NULL,
  device_ns INTEGER NOT NULL, device_count INTEGER NOT NULL, pre_roll INTEGER NOT NULL,
  pose_status INTEGER NOT NULL, world_from_image BLOB, tracker_from_probe BLOB,
  width INTEGER NOT NULL, height INTEGER NOT NULL, kind INTEGER NOT NULL,
  codec INTEGER NOT NULL, pixels_checked INTEGER NOT NULL, checked INTEGER NOT NULL);
CREATE TABLE pixels(id INTEGER PRIMARY KEY, bytes BLOB NOT NULL);
CREATE TABLE pose(
  id INTEGER PRIMARY KEY, time_ns INTEGER NOT NULL, arrived_ns INTEGER NOT NULL, quality INTEGER NOT NULL,
  epoch INTEGER NOT NULL, device_frame INTEGER NOT NULL, device_ms INTEGER NOT NULL,
  tracker_from_probe BLOB NOT NULL, checked INTEGER NOT NULL);
CREATE TABLE review(
  id INTEGER PRIMARY KEY, object TEXT NOT NULL, kind TEXT NOT NULL, version INTEGER NOT NULL,
  removed INTEGER NOT NULL, written_utc_ns INTEGER NOT NULL, json TEXT NOT NULL, png BLOB,
  checked INTEGER NOT NULL, UNIQUE(object, version));
)sql";

// Nothing recorded is ever rewritten: the file itself refuses.
std::string only_additions() {
  std::string sql;
  for (const char* table :
       {"exam", "label", "event", "sweep", "sweep_end", "frame", "pixels", "pose", "review"}) {
    for (const char* change : {"UPDATE", "DELETE"}) {
      sql += std::string("CREATE TRIGGER ") + table + "_refuses_" + change + " BEFORE " + change + " ON " +
             table + " BEGIN SELECT RAISE(ABORT, 'rows of an exam are only ever added'); END;\n";
    }
  }
  return sql;
}

std::int64_t schema_of(const Database& database, std::size_t known) {
  const std::int64_t application = database.integer("PRAGMA application_id");
  const std::int64_t schema = database.integer("PRAGMA user_version");
  const bool empty = schema == 0 && database.integer("SELECT count(*) FROM sqlite_schema") == 0;
  if (!empty && application != application_id)
    throw StoreError(StoreError::Kind::refused,
                     database.file() + ": this is a database, but not an exam of Sonoband's");
  if (schema < 0 || schema > static_cast<std::int64_t>(known)) {
    throw StoreError(StoreError::Kind::newer, database.file() + ": made by a newer Sonoband (its schema is " +
                                                  std::to_string(schema) + ", this program knows up to " +
                                                  std::to_string(known) + "): open it with that one");
  }
  return schema;
}

}  // namespace

std::span<const std::string> migrations() {
  static const std::array<std::string, 1> steps = {first_schema + only_additions()};
  return steps;
}

void migrate(Database& database, std::span<const std::string> steps) {
  if (schema_of(database, steps.size()) == static_cast<std::int64_t>(steps.size())) return;
  for (;;) {
    Transaction transaction(database);
    // Asked again inside: another process may have been faster.
    const std::int64_t schema = schema_of(database, steps.size());
    if (schema == static_cast<std::int64_t>(steps.size())) return;
    database.run(steps[static_cast<std::size_t>(schema)]);
    database.run("PRAGMA application_id=" + std::to_string(application_id) +
                 "; PRAGMA user_version=" + std::to_string(schema + 1));
    transaction.commit();
  }
}

bool up_to_date(const Database& database, std::span<const std::string> steps) {
  return schema_of(database, steps.size()) == static_cast<std::int64_t>(steps.size());
}

}  // namespace sonoband::exam
