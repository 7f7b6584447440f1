#include "app/exchange/dicom_outbox.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>

#include "app/bad_input.h"

namespace sonoband::exchange {
namespace {

namespace fs = std::filesystem;
using exam::Statement;

constexpr std::int64_t schema = 1;

void sync(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

bool same_peer(const DicomPeer& a, const DicomPeer& b) {
  return a.title == b.title && a.host == b.host && a.port == b.port && a.our_title == b.our_title &&
         a.tls == b.tls;
}

}  // namespace

DicomOutbox::DicomOutbox(const fs::path& folder) : folder_(folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw BadInput(folder.string() + ": cannot be made: " + error.message());
  fs::permissions(folder, fs::perms::owner_all, error);
  lock_ = ::open((folder / ".lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
  if (lock_ < 0 || ::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    if (lock_ >= 0) ::close(lock_);
    throw BadInput(folder.string() + ": another program is sending from this outbox; wait for it to end");
  }
  const fs::path file = folder / "outbox.sqlite";
  database_ =
      exam::Database(file, fs::exists(file) ? exam::Database::Mode::write : exam::Database::Mode::create);
  database_.run("PRAGMA synchronous=FULL");
  if (database_.integer("PRAGMA user_version") != schema) {
    database_.run(
        "CREATE TABLE IF NOT EXISTS item(id INTEGER PRIMARY KEY, file TEXT NOT NULL, title TEXT NOT NULL, "
        "host TEXT NOT NULL, port INTEGER NOT NULL, our_title TEXT NOT NULL, tls INTEGER NOT NULL, trusted "
        "TEXT NOT NULL, certificate TEXT NOT NULL, key TEXT NOT NULL, attempts INTEGER NOT NULL DEFAULT 0, "
        "trouble TEXT NOT NULL DEFAULT '', UNIQUE(file, title, host, port))");
    database_.run("PRAGMA user_version=" + std::to_string(schema));
  }
}

DicomOutbox::~DicomOutbox() {
  if (lock_ >= 0) ::close(lock_);
}

fs::path DicomOutbox::new_file(const std::string& name) const {
  return folder_ / name;
}

void DicomOutbox::add(const fs::path& file, const DicomPeer& peer) {
  sync(file);
  sync(folder_);
  const std::string name = file.filename().string();
  const DicomTls tls = peer.tls.value_or(DicomTls{});
  Statement add = database_.prepare(
      "INSERT OR REPLACE INTO item(file, title, host, port, our_title, tls, trusted, certificate, key) "
      "VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)");
  const std::string trusted = tls.trusted.string();
  const std::string certificate = tls.certificate.string();
  const std::string key = tls.key.string();
  add.bind(1, std::string_view(name)).bind(2, std::string_view(peer.title));
  add.bind(3, std::string_view(peer.host)).bind(4, std::int64_t{peer.port});
  add.bind(5, std::string_view(peer.our_title)).bind(6, std::int64_t{peer.tls.has_value()});
  add.bind(7, std::string_view(trusted)).bind(8, std::string_view(certificate));
  add.bind(9, std::string_view(key)).run();
}

std::vector<DicomOutbox::Item> DicomOutbox::waiting() const {
  std::vector<Item> all;
  Statement row = database_.prepare(
      "SELECT id, file, title, host, port, our_title, tls, trusted, certificate, key, attempts, trouble FROM "
      "item ORDER BY id");
  while (row.step()) {
    Item item;
    item.id = row.integer(0);
    item.file = folder_ / fs::path(row.text(1)).filename();
    item.peer.title = row.text(2);
    item.peer.host = row.text(3);
    item.peer.port = static_cast<std::uint16_t>(row.integer(4));
    item.peer.our_title = row.text(5);
    if (row.integer(6) != 0) item.peer.tls = DicomTls{row.text(7), row.text(8), row.text(9)};
    item.attempts = row.integer(10);
    item.trouble = row.text(11);
    all.push_back(std::move(item));
  }
  return all;
}

std::vector<std::string> DicomOutbox::send(const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<std::string> sentences;
  std::vector<Item> items = waiting();
  const std::size_t all = items.size();
  std::size_t sent = 0;
  const auto failed = [&](const Item& item, const std::string& why) {
    Statement note = database_.prepare("UPDATE item SET attempts = attempts + 1, trouble = ?2 WHERE id = ?1");
    note.bind(1, item.id).bind(2, std::string_view(why)).run();
  };
  while (!items.empty()) {
    std::vector<Item> now;
    std::vector<Item> later;
    for (Item& item : items)
      (now.empty() || same_peer(item.peer, now.front().peer) ? now : later).push_back(std::move(item));
    std::vector<fs::path> files;
    for (const Item& item : now) files.push_back(item.file);
    std::vector<bool> answered(now.size(), false);
    const auto take_answer = [&](std::size_t i, const std::string& why) {
      answered[i] = true;
      if (!why.empty()) {
        failed(now[i], why);
        sentences.push_back(why);
        return;
      }
      // The row first: a file without a row is only room lost, a row without a file would be a riddle.
      Statement remove = database_.prepare("DELETE FROM item WHERE id = ?1");
      remove.bind(1, now[i].id).run();
      const std::string name = now[i].file.filename().string();
      Statement other = database_.prepare("SELECT 1 FROM item WHERE file = ?1");
      std::error_code none;
      if (!other.bind(1, std::string_view(name)).step()) fs::remove(now[i].file, none);
      ++sent;
      if (progress) progress(sent, all);
    };
    const std::string trouble = send_dicom(files, now.front().peer, take_answer);
    if (!trouble.empty()) {
      sentences.push_back(trouble);
      for (std::size_t i = 0; i < now.size(); ++i)
        if (!answered[i]) failed(now[i], trouble);
    }
    items = std::move(later);
  }
  return sentences;
}

}  // namespace sonoband::exchange
