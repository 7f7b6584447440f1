// The Export sheet: what was chosen on it, and what it shows of the exporter. One thread, the screen's.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/exam/cart_exams.h"
#include "app/screen/exam_shelf.h"
#include "app/screen/exporter.h"
#include "app/screen/session.h"
#include "ui/command.h"

namespace sonoband {

class ExportDesk {
 public:
  ExportDesk(exam::CartExams& exams, Session& session, ExamShelf& shelf, ExporterSettings settings,
             std::function<void()> news);

  // True: there is something new to draw.
  bool listen(Stamp now);
  void fill(ui::ExportView& view);
  // The sheet is about to open: over the Exams page for the exam selected there, over Review for the sweep
  // shown (`shown`). False: that sweep is not on the disk yet.
  bool open(const std::optional<SweepKey>& shown);
  // False: it is not about exports.
  bool carry_out(const ui::Command& command);

 private:
  void choose(const ui::ExportChoice& choice);
  void start(std::uint64_t row);
  void say_outcome();

  exam::CartExams& exams_;
  Session& session_;
  ExamShelf& shelf_;
  Exporter exporter_;
  Exporter::State state_;  // as shown
  ui::ExportChoice choice_;
  std::filesystem::path place_;  // chosen; empty: the first there is
  std::optional<Stamp> next_look_;
  int shown_permille_ = 0;
  bool changed_ = false;
  std::vector<ui::PlaceView> places_;  // lent
};

}  // namespace sonoband
