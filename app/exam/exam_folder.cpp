#include "app/exam/exam_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <random>
#include <system_error>
#include <thread>

#include "app/exam/exam_reader.h"
#include "app/exam/journal.h"

namespace sonoband::exam {
namespace {

// After an exam's id, of what a start found.
constexpr const char* said_cut_off = ": was cut off; ";
constexpr const char* said_open = ": was open when the cart stopped; ";

namespace fs = std::filesystem;

constexpr const char* extension = ".exam";
constexpr const char* deleted = ".deleted";
constexpr double comfortable_minutes = 10;
constexpr std::int64_t index_schema = 1;

std::string plural(std::int64_t n, const std::string& one) {
  return std::to_string(n) + " " + one + (n == 1 ? "" : "s");
}

// What tells that a file is as the index saw it: sizes of file and journal, time of the last change.
std::string fingerprint(const fs::path& file) {
  struct stat s {};
  struct stat journal {};
  if (::stat(file.c_str(), &s) != 0) return {};
  ::stat((file.string() + "-wal").c_str(), &journal);
  const auto time = [](const timespec& t) {
    return std::to_string(t.tv_sec) + "." + std::to_string(t.tv_nsec);
  };
  return std::to_string(s.st_size) + " " + time(s.st_mtim) + " " + std::to_string(journal.st_size) + " " +
         time(journal.st_mtim);
}

std::vector<fs::path> exam_files(const fs::path& place) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& e : fs::directory_iterator(place, error))
    if (e.path().extension() == extension && e.is_regular_file(error)) files.push_back(e.path());
  if (error)
    throw StoreError(StoreError::Kind::failing, place.string() + ": cannot be listed: " + error.message());
  // Names begin with the date: newest first.
  std::sort(files.rbegin(), files.rend());
  return files;
}

// The index holds nothing that the exams do not: when it is damaged or of another schema it is made anew, and
// when it cannot be written, listing only takes longer.
class Index {
 public:
  explicit Index(const fs::path& place) {
    const fs::path file = place / "index.sqlite";
    try {
      open(file);
    } catch (const StoreError&) {
      close();
      std::error_code none;
      for (const char* end : {"", "-journal", "-wal", "-shm"}) fs::remove(file.string() + end, none);
      try {
        open(file);
      } catch (const StoreError&) {
        close();
      }
    }
  }

  bool find(const std::string& name, const std::string& print, ExamSummary& out) {
    if (!database_) return false;
    try {
      find_.reset();
      if (!find_.bind(1, std::string_view(name)).bind(2, std::string_view(print)).step()) return false;
      out.id = find_.text(0);
      out.created_utc_ns = find_.integer(1);
      out.label = find_.text(2);
      out.sweeps = find_.integer(3);
      out.frames = find_.integer(4);
      out.bytes = find_.integer(5);
      out.closed = find_.integer(6) != 0;
      find_.reset();
      return true;
    } catch (const StoreError&) {
      close();
      return false;
    }
  }

  void put(const std::string& name, const std::string& print, const ExamSummary& s) {
    if (!database_) return;
    try {
      put_.bind(1, std::string_view(name)).bind(2, std::string_view(print)).bind(3, std::string_view(s.id));
      put_.bind(4, s.created_utc_ns).bind(5, std::string_view(s.label)).bind(6, s.sweeps).bind(7, s.frames);
      put_.bind(8, s.bytes).bind(9, std::int64_t{s.closed}).run();
    } catch (const StoreError&) {
      close();
    }
  }

 private:
  void open(const fs::path& file) {
    database_ = Database(file, fs::exists(file) ? Database::Mode::write : Database::Mode::create);
    if (database_.integer("PRAGMA user_version") != index_schema) {
      database_.run(
          "DROP TABLE IF EXISTS entry; CREATE TABLE entry(name TEXT PRIMARY KEY, print TEXT, id TEXT, "
          "created_utc_ns "
          "INTEGER, label TEXT, sweeps INTEGER, frames INTEGER, bytes INTEGER, closed INTEGER)");
      database_.run("PRAGMA user_version=" + std::to_string(index_schema));
    }
    find_ = database_.prepare(
        "SELECT id, created_utc_ns, label, sweeps, frames, bytes, closed FROM entry WHERE name = ?1 AND "
        "print = ?2");
    put_ = database_.prepare("INSERT OR REPLACE INTO entry VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)");
  }
  void close() {
    find_ = {};
    put_ = {};
    database_ = {};
  }

  Database database_;
  Statement find_;
  Statement put_;
};

}  // namespace

fs::path default_exam_folder() {
  if (const char* data = std::getenv("XDG_DATA_HOME"); data != nullptr && *data != '\0')
    return fs::path(data) / "sonoband" / "exams";
  const char* home = std::getenv("HOME");
  return fs::path(home == nullptr ? "." : home) / ".local" / "share" / "sonoband" / "exams";
}

Room room_left(const fs::path& place, std::int64_t reserve_bytes, double bytes_per_second) {
  Room room;
  room.reserve_bytes = reserve_bytes;
  struct statvfs disk {};
  if (::statvfs(place.c_str(), &disk) != 0) {
    room.free_bytes = -1;
    room.sentence = "The disk for exams does not answer: check that it is attached.";
    return room;
  }
  room.free_bytes = static_cast<std::int64_t>(disk.f_bavail) * static_cast<std::int64_t>(disk.f_frsize);
  const double usable = static_cast<double>(std::max<std::int64_t>(room.free_bytes - reserve_bytes, 0));
  room.minutes = bytes_per_second > 0 ? usable / bytes_per_second / 60 : 0;
  room.may_start = room.free_bytes > reserve_bytes;
  if (!room.may_start) {
    room.sentence = "No room for another sweep: export exams and delete them, or attach another disk.";
  } else if (bytes_per_second > 0 && room.minutes < comfortable_minutes) {
    room.sentence =
        "Room for " + std::to_string(static_cast<int>(room.minutes)) + " more minutes of recording.";
  }
  return room;
}

ExamFolder::ExamFolder(const fs::path& place, Use use, Duration lock_wait) : place_(place) {
  std::error_code error;
  if (use == Use::cart) {
    fs::create_directories(place, error);
    if (error)
      throw StoreError(StoreError::Kind::refused, place.string() + ": cannot be made: " + error.message());
    fs::permissions(place, fs::perms::owner_all, error);
    const fs::path lock = place / ".lock";
    lock_ = ::open(lock.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
    if (lock_ < 0)
      throw StoreError(StoreError::Kind::refused,
                       place.string() + ": cannot be written; choose another with --exams");
    const auto give_up = std::chrono::steady_clock::now() + lock_wait;
    int locked = ::flock(lock_, LOCK_EX | LOCK_NB);
    while (locked != 0 && std::chrono::steady_clock::now() < give_up) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      locked = ::flock(lock_, LOCK_EX | LOCK_NB);
    }
    if (locked != 0) {
      ::close(lock_);
      throw StoreError(StoreError::Kind::refused,
                       place.string() +
                           ": another cart program keeps its exams here; end it, or choose another "
                           "folder with --exams");
    }
    recover();
  } else if (!fs::is_directory(place, error)) {
    throw StoreError(StoreError::Kind::refused, place.string() + ": there is no such folder of exams");
  }
}

ExamFolder::~ExamFolder() {
  if (lock_ >= 0) ::close(lock_);
}

ExamFolder::NewExam ExamFolder::new_exam() const {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  char date[32];
  std::strftime(date, sizeof date, "%Y%m%d-%H%M%S", &utc);
  std::random_device random;
  for (;;) {
    char id[48];
    std::snprintf(id, sizeof id, "%s-%04x", date, random() & 0xffffU);
    const fs::path file = file_of(id);
    if (!fs::exists(file)) return {id, file};
  }
}

fs::path ExamFolder::file_of(const std::string& id) const {
  return place_ / (id + extension);
}

void ExamFolder::recover() {
  std::error_code error;
  // Exams that were being made hold nothing yet: they get their name only when whole.
  for (const fs::directory_entry& e : fs::directory_iterator(place_, error)) {
    const std::string name = e.path().filename().string();
    if (name.find(std::string(extension) + ".new") != std::string::npos) fs::remove(e.path(), error);
  }
  forget_deleted();
  for (const fs::path& file : exam_files(place_)) {
    try {
      std::string sentence = recover_exam(file);
      if (!sentence.empty()) recovered_.push_back(std::move(sentence));
    } catch (const StoreError& e) {
      recovered_.push_back(std::string(e.what()) + "; the other exams are not touched.");
    }
  }
}

bool was_cut_off(std::span<const std::string> recovered, const std::string& id) {
  return std::any_of(recovered.begin(), recovered.end(),
                     [&](const std::string& sentence) { return sentence.starts_with(id + said_cut_off); });
}

std::string recover_exam(const fs::path& file, const std::string& vfs) {
  const JournalState journal = journal_state(file);
  {
    ExamReader reader(file, vfs);
    if (reader.summary().closed && journal.bytes == 0) return {};
  }
  ExamWriter writer = ExamWriter::open(file, vfs);
  std::int64_t frames = 0;
  std::vector<std::int64_t> open = writer.sweeps_without_end();
  for (const std::int64_t sweep : open) {
    const std::int64_t stored = writer.stored_frames(sweep);
    frames += stored;
    writer.end_sweep(sweep, stored, {}, true);
  }
  // One that was merely under review has lost nothing.
  const bool whole = open.empty() && !journal.torn && !journal.damaged;
  std::string sentence = file.stem().string() + (whole ? said_open : said_cut_off);
  if (whole) {
    sentence += "everything in it had been saved";
  } else if (open.empty()) {
    sentence += "all its sweeps had been saved";
  } else {
    sentence += plural(frames, "frame") + " of " + plural(static_cast<std::int64_t>(open.size()), "sweep") +
                " that had no end yet " + (frames == 1 ? "is" : "are") + " saved";
  }
  if (journal.damaged) sentence += "; its journal is damaged, and what came behind the damage is lost";
  if (journal.torn) sentence += "; the last batch was not complete and is left out";
  sentence += ".";
  writer.add_event("recovered", sentence);
  writer.close();
  return sentence;
}

namespace {

// With what of its journal is there.
void rename_exam(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error)
    throw StoreError(StoreError::Kind::failing, from.string() + ": cannot be renamed: " + error.message());
  for (const char* end : {"-wal", "-shm"}) {
    std::error_code none;  // usually there is no journal
    fs::rename(from.string() + end, to.string() + end, none);
  }
}

}  // namespace

void ExamFolder::set_aside(const std::string& id) const {
  rename_exam(file_of(id), file_of(id).string() + deleted);
}

void ExamFolder::put_back(const std::string& id) const {
  rename_exam(file_of(id).string() + deleted, file_of(id));
}

void ExamFolder::forget_deleted() const {
  std::error_code error;
  std::vector<fs::path> files;
  for (const fs::directory_entry& e : fs::directory_iterator(place_, error))
    if (e.path().filename().string().find(std::string(extension) + deleted) != std::string::npos)
      files.push_back(e.path());
  for (const fs::path& file : files) fs::remove(file, error);
  if (error)
    throw StoreError(StoreError::Kind::failing,
                     place_.string() + ": a deleted exam cannot be removed: " + error.message());
}

ExamSummary summarize(const fs::path& file) {
  try {
    return ExamReader(file).summary();
  } catch (const StoreError& e) {
    ExamSummary broken;
    broken.id = file.stem().string();
    broken.path = file.string();
    broken.damage = e.what();
    std::error_code none;
    broken.bytes = static_cast<std::int64_t>(fs::file_size(file, none));
    return broken;
  }
}

std::vector<ExamSummary> ExamFolder::list() const {
  std::vector<ExamSummary> all;
  Index index(place_);
  for (const fs::path& file : exam_files(place_)) {
    const std::string name = file.filename().string();
    ExamSummary summary;
    if (!index.find(name, fingerprint(file), summary)) {
      summary = summarize(file);
      // Told after reading: that may have completed a journal.
      if (summary.damage.empty()) index.put(name, fingerprint(file), summary);
    }
    summary.path = file.string();
    all.push_back(std::move(summary));
  }
  return all;
}

fs::path ExamFolder::find(const std::string& exam) const {
  if (fs::is_regular_file(exam)) return exam;
  std::vector<fs::path> matches;
  for (const fs::path& file : exam_files(place_))
    if (file.stem().string().starts_with(exam)) matches.push_back(file);
  if (matches.size() == 1) return matches.front();
  throw StoreError(StoreError::Kind::refused,
                   place_.string() + ": " + (matches.empty() ? "no exam is" : "more than one exam is") +
                       " called '" + exam + "'; `sonoband-tool exams " + place_.string() + "` lists them");
}

}  // namespace sonoband::exam
