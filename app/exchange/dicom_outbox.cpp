#include "app/exchange/dicom_outbox.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <random>

#include "app/bad_input.h"
#include "app/exchange/dicom.h"

namespace sonoband::exchange {
namespace {

namespace fs = std::filesystem;
using exam::Statement;

constexpr std::int64_t schema = 2;

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
  const std::int64_t found = database_.integer("PRAGMA user_version");
  if (found > schema)
    throw BadInput(folder.string() +
                   ": this outbox is of a newer Sonoband; send what is in it with that one");
  if (found < 1) {
    database_.run(
        "CREATE TABLE IF NOT EXISTS item(id INTEGER PRIMARY KEY, file TEXT NOT NULL, title TEXT NOT NULL, "
        "host TEXT NOT NULL, port INTEGER NOT NULL, our_title TEXT NOT NULL, tls INTEGER NOT NULL, trusted "
        "TEXT NOT NULL, certificate TEXT NOT NULL, key TEXT NOT NULL, attempts INTEGER NOT NULL DEFAULT 0, "
        "trouble TEXT NOT NULL DEFAULT '', UNIQUE(file, title, host, port))");
    database_.run("PRAGMA user_version=1");
  }
  if (found < 2) {
    database_.run("BEGIN IMMEDIATE");
    for (const char* column : {"commitment INTEGER NOT NULL DEFAULT 0", "sent INTEGER NOT NULL DEFAULT 0",
                               "asked TEXT NOT NULL DEFAULT ''", "sop_class TEXT NOT NULL DEFAULT ''",
                               "sop_instance TEXT NOT NULL DEFAULT ''"})
      database_.run(std::string("ALTER TABLE item ADD COLUMN ") + column);
    database_.run("PRAGMA user_version=2");
    database_.run("COMMIT");
  }
}

DicomOutbox::~DicomOutbox() {
  if (lock_ >= 0) ::close(lock_);
}

fs::path DicomOutbox::new_file(const std::string& name) const {
  return folder_ / name;
}

void DicomOutbox::add(const fs::path& file, const DicomPeer& peer, bool commit) {
  sync(file);
  sync(folder_);
  const std::string name = file.filename().string();
  const DicomTls tls = peer.tls.value_or(DicomTls{});
  Statement add = database_.prepare(
      "INSERT OR REPLACE INTO item(file, title, host, port, our_title, tls, trusted, certificate, key, "
      "commitment) VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)");
  const std::string trusted = tls.trusted.string();
  const std::string certificate = tls.certificate.string();
  const std::string key = tls.key.string();
  add.bind(1, std::string_view(name)).bind(2, std::string_view(peer.title));
  add.bind(3, std::string_view(peer.host)).bind(4, std::int64_t{peer.port});
  add.bind(5, std::string_view(peer.our_title)).bind(6, std::int64_t{peer.tls.has_value()});
  add.bind(7, std::string_view(trusted)).bind(8, std::string_view(certificate));
  add.bind(9, std::string_view(key)).bind(10, std::int64_t{commit}).run();
}

std::vector<DicomOutbox::Item> DicomOutbox::waiting() const {
  std::vector<Item> all;
  Statement row = database_.prepare(
      "SELECT id, file, title, host, port, our_title, tls, trusted, certificate, key, attempts, trouble, "
      "commitment, sent, asked, sop_class, sop_instance FROM item ORDER BY id");
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
    item.commit = row.integer(12) != 0;
    item.sent = row.integer(13) != 0;
    item.transaction = row.text(14);
    item.object = {row.text(15), row.text(16)};
    all.push_back(std::move(item));
  }
  return all;
}

void DicomOutbox::note(std::int64_t id, const std::string& trouble) {
  Statement note = database_.prepare("UPDATE item SET attempts = attempts + 1, trouble = ?2 WHERE id = ?1");
  note.bind(1, id).bind(2, std::string_view(trouble)).run();
}

void DicomOutbox::remove(std::int64_t id, const fs::path& file) {
  // The row first: a file without a row is only room lost, a row without a file would be a riddle.
  Statement remove = database_.prepare("DELETE FROM item WHERE id = ?1");
  remove.bind(1, id).run();
  const std::string name = file.filename().string();
  Statement other = database_.prepare("SELECT 1 FROM item WHERE file = ?1");
  std::error_code none;
  if (!other.bind(1, std::string_view(name)).step()) fs::remove(file, none);
}

std::vector<std::string> DicomOutbox::send(const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<std::string> sentences;
  std::vector<Item> items = waiting();
  std::erase_if(items, [](const Item& item) { return item.sent; });
  const std::size_t all = items.size();
  std::size_t sent = 0;
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
        note(now[i].id, why);
        sentences.push_back(why);
        return;
      }
      if (!now[i].commit) {
        remove(now[i].id, now[i].file);
      } else {
        const DicomReference object = dicom_reference(now[i].file);
        Statement mark = database_.prepare(
            "UPDATE item SET sent = 1, trouble = '', sop_class = ?2, sop_instance = ?3 WHERE id = ?1");
        mark.bind(1, now[i].id).bind(2, std::string_view(object.sop_class));
        mark.bind(3, std::string_view(object.sop_instance)).run();
      }
      ++sent;
      if (progress) progress(sent, all);
    };
    const std::string trouble = send_dicom(files, now.front().peer, take_answer);
    if (!trouble.empty()) {
      sentences.push_back(trouble);
      for (std::size_t i = 0; i < now.size(); ++i)
        if (!answered[i]) note(now[i].id, trouble);
    }
    items = std::move(later);
  }
  return sentences;
}

bool DicomOutbox::take_answer(const CommitmentAnswer& answer, Committed& outcome) {
  bool known = false;
  for (const Item& item : waiting()) {
    if (item.transaction.empty() || item.transaction != answer.transaction) continue;
    known = true;
    if (std::find(answer.kept.begin(), answer.kept.end(), item.object) != answer.kept.end()) {
      remove(item.id, item.file);
      ++outcome.kept;
      continue;
    }
    const auto refused = std::find_if(answer.refused.begin(), answer.refused.end(),
                                      [&](const auto& r) { return r.object == item.object; });
    if (refused == answer.refused.end()) continue;  // not spoken of: still to be asked for
    const std::string why =
        fmt::format("{}: the archive does not keep it (reason {:04x}h); it is sent again next time",
                    item.file.filename().string(), refused->reason);
    Statement again = database_.prepare("UPDATE item SET sent = 0, asked = '' WHERE id = ?1");
    again.bind(1, item.id).run();
    note(item.id, why);
    outcome.trouble.push_back(why);
    ++outcome.refused;
  }
  return known;
}

DicomOutbox::Committed DicomOutbox::commit(std::uint16_t port, int wait_s) {
  Committed outcome;
  std::vector<Item> items = waiting();
  std::erase_if(items, [](const Item& item) { return !item.sent; });
  if (items.empty()) return outcome;
  const TakeAnswer take = [&](const CommitmentAnswer& answer) { return take_answer(answer, outcome); };
  std::optional<CommitmentListener> listener;
  if (port != 0) {
    // One port speaks TLS or not: as we do to the first, if we have a certificate to show.
    std::optional<DicomTls> tls = items.front().peer.tls;
    if (tls && tls->certificate.empty()) tls.reset();
    listener.emplace(port, items.front().peer.our_title, take, tls);
  }
  std::size_t asked = 0;
  std::random_device random;
  while (!items.empty()) {
    std::vector<Item> now;
    std::vector<Item> later;
    for (Item& item : items)
      (now.empty() || same_peer(item.peer, now.front().peer) ? now : later).push_back(std::move(item));
    const std::string transaction =
        dicom_uid(fmt::format("{:x} {:x} {:x} {:x}", random(), random(), random(), random()));
    std::vector<DicomReference> objects;
    for (const Item& item : now) {
      objects.push_back(item.object);
      Statement ask = database_.prepare("UPDATE item SET asked = ?2 WHERE id = ?1");
      ask.bind(1, item.id).bind(2, std::string_view(transaction)).run();
    }
    // With a port of ours the archive may come there at once; without, this association is its only way.
    const CommitmentAsked reply =
        ask_commitment(objects, now.front().peer, transaction, listener ? std::min(wait_s, 1) : wait_s, take);
    if (reply.outcome == Asked::not_offered) {
      for (const Item& item : now) remove(item.id, item.file);
      outcome.without.push_back(reply.sentence + "; what it has taken is taken as kept");
    } else if (reply.outcome == Asked::failed) {
      for (const Item& item : now) note(item.id, reply.sentence);
      outcome.trouble.push_back(reply.sentence);
      outcome.unanswered += now.size();
    } else {
      asked += now.size();
    }
    items = std::move(later);
  }
  const auto answered = [&] { return outcome.kept + outcome.refused; };
  if (listener) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(wait_s);
    listener->hear([&] { return answered() >= asked || std::chrono::steady_clock::now() >= until; });
  }
  outcome.unanswered += asked - std::min(asked, answered());
  return outcome;
}

}  // namespace sonoband::exchange
