// Between the session and the exams: what review makes is saved as it happens, sweeps come back from the
// disk, the Exams page's commands are carried out.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "app/exam/cart_exams.h"
#include "app/screen/exam_shelf.h"
#include "app/screen/export_desk.h"
#include "app/screen/review_objects.h"
#include "app/screen/session.h"

namespace sonoband {

class ExamDesk {
 public:
  // `news` is called on another thread.
  ExamDesk(exam::CartExams& exams, Session& session, const ExporterSettings& exports,
           const std::function<void()>& news);
  ~ExamDesk();  // hands over what is not saved yet
  ExamDesk(const ExamDesk&) = delete;
  ExamDesk& operator=(const ExamDesk&) = delete;

  // True: there is something new to draw.
  bool listen(Stamp now);
  // `recording`: the present exam grows.
  void fill(ui::ExamsView& view, bool recording);
  // False: it is not the exams' to carry out.
  bool carry_out(const ui::Command& command);
  // A snapshot of this window belongs to the sweep shown.
  void keep_snapshot(const std::filesystem::path& png, ui::Window window);

 private:
  // Of a sweep in memory or opened; empty while the store does not know it yet.
  std::optional<SweepKey> key_of(std::uint64_t sweep);
  std::uint64_t id_of(const SweepKey& key);
  void save_review(Stamp now, bool all);
  void open(const SweepKey& key);
  void take_opened();
  bool load_on(Stamp now);
  void remove(const std::string& exam);

  exam::CartExams& exams_;
  Session& session_;
  ExamShelf shelf_;
  ExportDesk export_;
  std::map<std::uint64_t, SweepKey> keys_;  // by the session's id
  std::map<SweepKey, std::uint64_t> ids_;
  std::map<std::uint64_t, ReviewLog> logs_;
  struct Loading {
    std::uint64_t id = 0;
    std::shared_ptr<exam::SweepLoader> loader;
    std::int64_t shown = 0;  // pictures visited when it was last shown
    std::optional<Stamp> next;
  };
  std::optional<Loading> loading_;
  std::uint64_t removals_answered_ = 0;
  bool changed_ = false;  // by a command
};

}  // namespace sonoband
