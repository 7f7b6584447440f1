#include "app/exam/sqlite.h"

#include <fcntl.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace sonoband::exam {
namespace {

// Nothing of ours is longer: a row's blob is one picture. A damaged or hostile file cannot ask for more.
constexpr int longest_blob_bytes = 256 << 20;
// Long enough for another process's checkpoint, short enough that a stuck one is said.
constexpr int busy_ms = 2000;

[[noreturn]] void fail(int code, const std::string& file, const std::string& what) {
  const std::string detail = what.empty() ? sqlite3_errstr(code) : what;
  switch (code & 0xff) {
    case SQLITE_FULL:
      throw StoreError(StoreError::Kind::full,
                       file + ": the disk is full; free some room or use another disk");
    case SQLITE_IOERR:
      throw StoreError(StoreError::Kind::failing, file + ": the disk does not answer as it should (" +
                                                      sqlite3_errstr(code) + "); check that it is attached");
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      throw StoreError(StoreError::Kind::damaged, file + ": the file is damaged (" + detail + ")");
    case SQLITE_READONLY:
      if (code == SQLITE_READONLY_DBMOVED)
        throw StoreError(StoreError::Kind::failing,
                         file + ": the file is no longer where it was; attach its disk again");
      throw StoreError(StoreError::Kind::refused, file + ": the file may not be written");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw StoreError(StoreError::Kind::refused, file + ": another program holds it; close that one");
    case SQLITE_TOOBIG:
    case SQLITE_ERROR:
    case SQLITE_MISMATCH:
    case SQLITE_CONSTRAINT:
      throw StoreError(StoreError::Kind::damaged,
                       file + ": not the tables that are expected (" + detail + ")");
    default:
      throw StoreError(StoreError::Kind::refused, file + ": " + detail);
  }
}

void make_private(const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0600);
  if (fd < 0) {
    const int why = errno;
    throw StoreError(why == ENOSPC || why == EDQUOT ? StoreError::Kind::full : StoreError::Kind::refused,
                     file.string() + ": cannot be made: " + std::strerror(why));
  }
  ::fchmod(fd, 0600);  // whatever the umask
  ::close(fd);
  // The name must survive a power cut as the contents do.
  const int folder = ::open(file.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
}

std::string uri_path(const std::string& path) {
  std::string escaped;
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#') {
      escaped += c == '%' ? "%25" : c == '?' ? "%3f" : "%23";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* s) const {
  sqlite3_finalize(s);
}

Statement& Statement::bind(int at, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), at, value);
  return *this;
}
Statement& Statement::bind(int at, double value) {
  sqlite3_bind_double(statement_.get(), at, value);
  return *this;
}
Statement& Statement::bind(int at, std::string_view value) {
  sqlite3_bind_text(statement_.get(), at, value.data() == nullptr ? "" : value.data(),
                    static_cast<int>(value.size()), SQLITE_STATIC);
  return *this;
}
Statement& Statement::bind(int at, std::span<const std::uint8_t> value) {
  sqlite3_bind_blob64(statement_.get(), at, value.data(), value.size(), SQLITE_STATIC);
  return *this;
}
Statement& Statement::bind_null(int at) {
  sqlite3_bind_null(statement_.get(), at);
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  sqlite3* db = sqlite3_db_handle(statement_.get());
  const int extended = sqlite3_extended_errcode(db);
  const std::string what = sqlite3_errmsg(db);
  sqlite3_reset(statement_.get());
  fail(extended, file_, what);
}
void Statement::run() {
  while (step()) {
  }
  reset();
}
void Statement::reset() {
  sqlite3_reset(statement_.get());
}

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}
double Statement::real(int column) const {
  return sqlite3_column_double(statement_.get(), column);
}
std::string Statement::text(int column) const {
  const unsigned char* text = sqlite3_column_text(statement_.get(), column);
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
}
std::span<const std::uint8_t> Statement::blob(int column) const {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const int bytes = sqlite3_column_bytes(statement_.get(), column);
  // Reading a long blob may itself meet damage; SQLite then gives a null pointer for a blob with a length.
  if (data == nullptr) {
    const int code = sqlite3_extended_errcode(sqlite3_db_handle(statement_.get()));
    if (code != SQLITE_OK && code != SQLITE_ROW && code != SQLITE_DONE) fail(code, file_, {});
    return {};
  }
  return {static_cast<const std::uint8_t*>(data), static_cast<std::size_t>(bytes)};
}
bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

void Database::Close::operator()(sqlite3* d) const {
  sqlite3_close_v2(d);
}

Database::Database(const std::filesystem::path& file, Mode mode, const std::string& vfs)
    : file_(file.filename().string()) {
  if (mode == Mode::create) make_private(file);
  sqlite3* handle = nullptr;
  const char* system = vfs.empty() ? nullptr : vfs.c_str();
  int code = sqlite3_open_v2(file.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_FULLMUTEX, system);
  if (code == SQLITE_OK && mode == Mode::read && sqlite3_db_readonly(handle, "main") == 1) {
    // A read-only medium cannot take the journal's companion files; without a journal it needs none.
    sqlite3_close_v2(handle);
    const std::string uri = "file:" + uri_path(file.string()) + "?immutable=1";
    code = sqlite3_open_v2(uri.c_str(), &handle,
                           SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_FULLMUTEX, system);
  }
  database_.reset(handle);
  if (code != SQLITE_OK) {
    const int extended = handle == nullptr ? code : sqlite3_extended_errcode(handle);
    fail(extended, file_, "cannot be opened: " + std::string(sqlite3_errstr(code)));
  }
  sqlite3_extended_result_codes(handle, 1);
  sqlite3_busy_timeout(handle, busy_ms);
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, longest_blob_bytes);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  // A file from outside may hold any schema: none of its functions run, and its cells are checked.
  run("PRAGMA trusted_schema=OFF; PRAGMA cell_size_check=ON; PRAGMA temp_store=MEMORY");
  // The journal outlives a crash of a reader; it is emptied where the writer says so, never by a close.
  if (mode == Mode::read) run("PRAGMA query_only=ON");
}

void Database::run(const std::string& sql) {
  const int code = sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) {
    const std::string what = sqlite3_errmsg(database_.get());
    fail(sqlite3_extended_errcode(database_.get()), file_, what);
  }
}

Statement Database::prepare(std::string_view sql) const {
  sqlite3_stmt* raw = nullptr;
  const int code = sqlite3_prepare_v3(database_.get(), sql.data(), static_cast<int>(sql.size()),
                                      SQLITE_PREPARE_PERSISTENT, &raw, nullptr);
  if (code != SQLITE_OK) {
    const std::string what = sqlite3_errmsg(database_.get());
    fail(sqlite3_extended_errcode(database_.get()), file_, what);
  }
  Statement statement;
  statement.statement_.reset(raw);
  statement.file_ = file_;
  return statement;
}

std::int64_t Database::integer(std::string_view sql) const {
  Statement s = prepare(sql);
  return s.step() ? s.integer(0) : 0;
}

std::string Database::text(std::string_view sql) const {
  Statement s = prepare(sql);
  return s.step() ? s.text(0) : std::string();
}

std::int64_t Database::changes() const {
  return sqlite3_changes64(database_.get());
}

bool Database::checkpoint(bool empty_journal) {
  int in_journal = 0;
  int copied = 0;
  const int code = sqlite3_wal_checkpoint_v2(
      database_.get(), nullptr, empty_journal ? SQLITE_CHECKPOINT_TRUNCATE : SQLITE_CHECKPOINT_PASSIVE,
      &in_journal, &copied);
  if (code == SQLITE_BUSY || code == SQLITE_LOCKED) return false;  // a reader; the journal keeps it safe
  if (code != SQLITE_OK) fail(sqlite3_extended_errcode(database_.get()), file_, {});
  return in_journal == copied;
}

Transaction::Transaction(Database& database) : database_(database) {
  database_.run("BEGIN IMMEDIATE");
}
Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.run("ROLLBACK");
  } catch (const StoreError&) {
    // Some failures have already rolled back; there is nothing left to undo.
  }
}
void Transaction::commit() {
  database_.run("COMMIT");
  open_ = false;
}

}  // namespace sonoband::exam
