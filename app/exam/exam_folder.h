// The place where exams lie: one file each, and an index that is only a convenience and can be rebuilt.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "app/exam/exam_writer.h"
#include "app/exam/records.h"

namespace sonoband::exam {

// $XDG_DATA_HOME/sonoband/exams, or ~/.local/share/sonoband/exams.
std::filesystem::path default_exam_folder();

struct Room {
  std::int64_t free_bytes = 0;     // for this user; negative: cannot be told, the disk does not answer
  std::int64_t reserve_bytes = 0;  // kept free: a sweep does not start below it
  double minutes = 0;              // of recording until the reserve is reached
  bool may_start = false;
  std::string sentence;  // what to do; empty while there are ten minutes and more
};

// Asks the disk; may take long when that is in trouble.
Room room_left(const std::filesystem::path& place, std::int64_t reserve_bytes, double bytes_per_second);

class ExamFolder {
 public:
  enum class Use : std::uint8_t {
    cart,  // alone: makes the folder (0700), holds its lock, closes what was cut off
    look,  // beside others: lists and reads
  };
  // Throws StoreError when the folder cannot be used; as `cart` also when another cart still uses it after
  // `lock_wait`: one that is just ending lets go within moments.
  ExamFolder(const std::filesystem::path& place, Use use, Duration lock_wait = {});
  ~ExamFolder();
  ExamFolder(const ExamFolder&) = delete;
  ExamFolder& operator=(const ExamFolder&) = delete;

  const std::filesystem::path& place() const { return place_; }
  // What the start found cut off or damaged: one sentence for each exam, for the screen.
  const std::vector<std::string>& recovered() const { return recovered_; }

  // A fresh file name and id; ExamWriter::create makes it.
  struct NewExam {
    std::string id;
    std::filesystem::path file;
  };
  NewExam new_exam() const;
  std::filesystem::path file_of(const std::string& id) const;

  // Newest first. Exams that did not change since are told from the index; damaged ones are listed with
  // their damage.
  std::vector<ExamSummary> list() const;

  // A deleted exam leaves the list at once and its file when forget_deleted is called, at the latest with the
  // next start. Throw StoreError.
  void set_aside(const std::string& id) const;
  void put_back(const std::string& id) const;
  void forget_deleted() const;

  // By id, by an unambiguous beginning of one, or by path. Throws StoreError naming what is there.
  std::filesystem::path find(const std::string& exam) const;

 private:
  void recover();

  std::filesystem::path place_;
  int lock_ = -1;
  std::vector<std::string> recovered_;
};

// Closes an exam that was cut off: gives every sweep its end, empties the journal, says what was there in one
// sentence (empty: it had been closed in order). Throws StoreError when the file is too damaged for that.
std::string recover_exam(const std::filesystem::path& file, const std::string& vfs = {});

// Whether these sentences of a start say that something of the exam was cut off: not of one that was merely
// open, as under review.
bool was_cut_off(std::span<const std::string> recovered, const std::string& id);

// An exam's summary, or its name and what is wrong with it.
ExamSummary summarize(const std::filesystem::path& file);

}  // namespace sonoband::exam
