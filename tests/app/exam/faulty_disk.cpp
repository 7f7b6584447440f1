#include "tests/app/exam/faulty_disk.h"

#include <sqlite3.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <fstream>
#include <iterator>
#include <new>

namespace sonoband::exam::test {
namespace {

constexpr std::size_t sector_bytes = 512;

struct File {
  sqlite3_file base;  // first: SQLite sees only this
  FaultyDisk* disk;
  std::string* path;
  sqlite3_file* below;  // in the memory behind this struct
};

File& of(sqlite3_file* f) {
  return *reinterpret_cast<File*>(f);
}

int close(sqlite3_file* f) {
  const int code = of(f).below->pMethods->xClose(of(f).below);
  delete of(f).path;
  return code;
}
int read(sqlite3_file* f, void* data, int bytes, sqlite3_int64 offset) {
  const int code = of(f).disk->answer(FaultyDisk::Operation::read);
  return code != SQLITE_OK ? SQLITE_IOERR_READ
                           : of(f).below->pMethods->xRead(of(f).below, data, bytes, offset);
}
int write(sqlite3_file* f, const void* data, int bytes, sqlite3_int64 offset) {
  int code = of(f).disk->answer(FaultyDisk::Operation::write);
  if (code == SQLITE_OK) code = of(f).below->pMethods->xWrite(of(f).below, data, bytes, offset);
  if (code == SQLITE_OK) of(f).disk->wrote(*of(f).path, data, bytes, offset);
  return code;
}
int truncate(sqlite3_file* f, sqlite3_int64 size) {
  int code = of(f).disk->answer(FaultyDisk::Operation::other);
  if (code == SQLITE_OK) code = of(f).below->pMethods->xTruncate(of(f).below, size);
  if (code == SQLITE_OK) of(f).disk->truncated(*of(f).path, size);
  return code;
}
// The platter is ours, so the real disk need not be bothered.
int sync(sqlite3_file* f, int) {
  const int code = of(f).disk->answer(FaultyDisk::Operation::other);
  if (code == SQLITE_OK) of(f).disk->synced(*of(f).path);
  return code;
}
int size(sqlite3_file* f, sqlite3_int64* bytes) {
  return of(f).below->pMethods->xFileSize(of(f).below, bytes);
}
int lock(sqlite3_file* f, int level) {
  return of(f).below->pMethods->xLock(of(f).below, level);
}
int unlock(sqlite3_file* f, int level) {
  return of(f).below->pMethods->xUnlock(of(f).below, level);
}
int reserved(sqlite3_file* f, int* out) {
  return of(f).below->pMethods->xCheckReservedLock(of(f).below, out);
}
int control(sqlite3_file* f, int what, void* with) {
  return of(f).below->pMethods->xFileControl(of(f).below, what, with);
}
int sector(sqlite3_file* f) {
  return of(f).below->pMethods->xSectorSize(of(f).below);
}
// No promises beyond a plain disk's: a real one may report that appends are safe.
int character(sqlite3_file*) {
  return 0;
}
int shm_map(sqlite3_file* f, int region, int bytes, int extend, void volatile** at) {
  return of(f).below->pMethods->xShmMap(of(f).below, region, bytes, extend, at);
}
int shm_lock(sqlite3_file* f, int offset, int count, int flags) {
  return of(f).below->pMethods->xShmLock(of(f).below, offset, count, flags);
}
void shm_barrier(sqlite3_file* f) {
  of(f).below->pMethods->xShmBarrier(of(f).below);
}
int shm_unmap(sqlite3_file* f, int remove) {
  return of(f).below->pMethods->xShmUnmap(of(f).below, remove);
}

const sqlite3_io_methods methods = {2,        close,       read,      write,   truncate, sync,      size,
                                    lock,     unlock,      reserved,  control, sector,   character, shm_map,
                                    shm_lock, shm_barrier, shm_unmap, nullptr, nullptr};

FaultyDisk& disk_of(sqlite3_vfs* v) {
  return *static_cast<FaultyDisk*>(v->pAppData);
}

int open(sqlite3_vfs* v, sqlite3_filename path, sqlite3_file* f, int flags, int* out_flags) {
  FaultyDisk& disk = disk_of(v);
  f->pMethods = nullptr;
  if (disk.answer(FaultyDisk::Operation::read) != SQLITE_OK) return SQLITE_CANTOPEN;
  sqlite3_file* below = reinterpret_cast<sqlite3_file*>(reinterpret_cast<char*>(f) + sizeof(File));
  const int code = disk.below()->xOpen(disk.below(), path, below, flags, out_flags);
  if (code != SQLITE_OK) {
    if (below->pMethods != nullptr) below->pMethods->xClose(below);
    return code;
  }
  ::new (f) File{{&methods}, &disk, new std::string(path == nullptr ? "" : path), below};
  disk.opened(*of(f).path);
  return SQLITE_OK;
}
int remove(sqlite3_vfs* v, const char* path, int sync_folder) {
  FaultyDisk& disk = disk_of(v);
  int code = disk.answer(FaultyDisk::Operation::other);
  if (code == SQLITE_OK) code = disk.below()->xDelete(disk.below(), path, sync_folder);
  if (code == SQLITE_OK) disk.deleted(path);
  return code;
}

}  // namespace

FaultyDisk::FaultyDisk(std::uint64_t seed) : random_(seed), below_(sqlite3_vfs_find(nullptr)) {
  static std::atomic<int> number{0};
  name_ = "faulty" + std::to_string(number++);
  vfs_ = new sqlite3_vfs(*below_);
  vfs_->iVersion = std::min(below_->iVersion, 2);
  vfs_->szOsFile = static_cast<int>(sizeof(File)) + below_->szOsFile;
  vfs_->zName = name_.c_str();
  vfs_->pNext = nullptr;
  vfs_->pAppData = this;
  vfs_->xOpen = open;
  vfs_->xDelete = remove;
  // The rest of the usual file system's functions know nothing of their own struct's state.
  sqlite3_vfs_register(vfs_, 0);
}

FaultyDisk::~FaultyDisk() {
  sqlite3_vfs_unregister(vfs_);
  delete vfs_;
}

void FaultyDisk::fail_at(std::int64_t change, Fault fault) {
  const std::lock_guard lock(mutex_);
  changes_ = 0;
  fails_at_ = change;
  fault_ = fault;
  failing_ = false;
}
void FaultyDisk::heal() {
  fail_at(-1, Fault::full);
}
std::int64_t FaultyDisk::changes() const {
  const std::lock_guard lock(mutex_);
  return changes_;
}

int FaultyDisk::answer(Operation operation) {
  const std::lock_guard lock(mutex_);
  if (operation != Operation::read && changes_++ == fails_at_) failing_ = true;
  if (!failing_) return SQLITE_OK;
  if (fault_ == Fault::full) return operation == Operation::write ? SQLITE_FULL : SQLITE_OK;
  return SQLITE_IOERR;
}

void FaultyDisk::opened(const std::string& path) {
  const std::lock_guard lock(mutex_);
  const auto [at, is_new] = files_.try_emplace(path);
  if (!is_new) return;
  std::ifstream in(path, std::ios::binary);
  at->second.synced.assign(std::istreambuf_iterator<char>(in), {});
}
void FaultyDisk::wrote(const std::string& path, const void* data, int bytes, std::int64_t offset) {
  const auto* from = static_cast<const std::uint8_t*>(data);
  const std::lock_guard lock(mutex_);
  files_[path].since.push_back({offset, {from, from + bytes}, false});
}
void FaultyDisk::truncated(const std::string& path, std::int64_t new_size) {
  const std::lock_guard lock(mutex_);
  files_[path].since.push_back({new_size, {}, true});
}
void FaultyDisk::synced(const std::string& path) {
  const std::lock_guard lock(mutex_);
  Platter& platter = files_[path];
  for (const Change& change : platter.since) apply(platter.synced, change, change.bytes.size());
  platter.since.clear();
}
void FaultyDisk::deleted(const std::string& path) {
  const std::lock_guard lock(mutex_);
  files_.erase(path);
}

void FaultyDisk::apply(std::vector<std::uint8_t>& content, const Change& change, std::size_t bytes) {
  if (change.truncation) {
    content.resize(static_cast<std::size_t>(change.offset));
    return;
  }
  const std::size_t at = static_cast<std::size_t>(change.offset);
  if (content.size() < at + bytes) content.resize(at + bytes);
  std::copy_n(change.bytes.begin(), bytes, content.begin() + static_cast<std::ptrdiff_t>(at));
}

void FaultyDisk::cut_power() {
  const std::lock_guard lock(mutex_);
  // Of the unsynced writes the disk may have kept all, none, or some.
  const std::uint64_t kept_of_four = random_() % 5;
  for (auto& [path, platter] : files_) {
    std::vector<const Change*> kept;
    for (const Change& change : platter.since)
      if (random_() % 4 < kept_of_four) kept.push_back(&change);
    for (const Change* change : kept) {
      std::size_t bytes = change->bytes.size();
      if (change == kept.back() && random_() % 2 == 0)
        bytes = std::min(bytes, random_() % (bytes / sector_bytes + 1) * sector_bytes);
      apply(platter.synced, *change, bytes);
    }
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(platter.synced.data()),
               static_cast<std::streamsize>(platter.synced.size()));
    // Shared memory does not outlive the power.
    std::filesystem::remove(path + "-shm");
  }
  files_.clear();
}

}  // namespace sonoband::exam::test
