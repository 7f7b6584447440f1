// SQLite, closed behind two small types. Every failure leaves here as StoreError.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace sonoband::exam {

// What went wrong with a store, and what it is called in a sentence. The sentence names the file.
class StoreError : public std::runtime_error {
 public:
  enum class Kind : std::uint8_t {
    full,     // no room on the disk
    failing,  // the disk does not read, write or sync, or is gone
    damaged,  // what is there is not what was written
    refused,  // the file cannot be opened, or another program holds it
    newer,    // made by a later Sonoband
  };
  StoreError(Kind kind, const std::string& sentence) : std::runtime_error(sentence), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

class Statement {
 public:
  Statement() = default;

  // Parameters count from 1. Blobs and texts are borrowed: they must live until reset or the next bind.
  Statement& bind(int at, std::int64_t value);
  Statement& bind(int at, double value);
  Statement& bind(int at, std::string_view value);
  Statement& bind(int at, std::span<const std::uint8_t> value);
  Statement& bind_null(int at);

  bool step();  // true: a row is there
  void run();   // steps to the end, then resets
  void reset();

  // Columns count from 0; views live until the next step or reset.
  std::int64_t integer(int column) const;
  double real(int column) const;
  std::string text(int column) const;
  std::span<const std::uint8_t> blob(int column) const;
  bool is_null(int column) const;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* s) const;
  };
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  std::string file_;
};

class Database {
 public:
  enum class Mode : std::uint8_t { create, write, read };

  Database() = default;
  // `create` makes an empty file that only this user can read (0600) and fails if there is one. `read` may
  // still complete an interrupted journal. `vfs` names one of SQLite's file systems; empty is the usual one.
  Database(const std::filesystem::path& file, Mode mode, const std::string& vfs = {});

  explicit operator bool() const { return database_ != nullptr; }
  void run(const std::string& sql);
  Statement prepare(std::string_view sql) const;
  std::int64_t integer(std::string_view sql) const;  // the first column of the first row
  std::string text(std::string_view sql) const;
  std::int64_t changes() const;
  const std::string& file() const { return file_; }  // its name, for sentences

  // Copies the journal into the file as far as readers allow; true when all of it is there. `empty_journal`
  // also cuts the journal to nothing.
  bool checkpoint(bool empty_journal);

 private:
  struct Close {
    void operator()(sqlite3* d) const;
  };
  std::unique_ptr<sqlite3, Close> database_;
  std::string file_;
};

// Rolls back when it goes out of scope without commit.
class Transaction {
 public:
  explicit Transaction(Database& database);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit();

 private:
  Database& database_;
  bool open_ = true;
};

}  // namespace sonoband::exam
