// The Exams page over the store: which exams there are, their pictures, and a sweep on its way back to
// memory. What the disk has to say comes on a thread of its own; the screen never waits for it.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "app/exam/cart_exams.h"
#include "app/exam/sweep_loader.h"
#include "app/screen/render_worker.h"
#include "ui/command.h"
#include "ui/view.h"

namespace sonoband {

using SweepKey = std::pair<std::string, std::int64_t>;  // exam and number of the sweep in it

// What a row shows of one sweep.
struct SweepCard {
  Pixels picture;  // the one in the middle; empty: none is whole
  PixelKind kind = PixelKind::grey;
  std::int64_t frames = 0;
  double seconds = 0;
  std::uint64_t version = 0;  // of the picture
};

// A sweep whose first picture is there; the others follow by themselves.
struct OpenedSweep {
  SweepKey key;
  std::string label;
  std::string when;
  std::shared_ptr<exam::SweepLoader> loader;
  std::vector<exam::ReviewObject> review;
  std::string trouble;  // one sentence; with a loader: what of it is damaged, without: why it does not open
};

// Of the frames that are there: what was swept and has a place in space.
HeldSweep held_of(const std::shared_ptr<exam::SweepLoader>& loader);

class ExamShelf {
 public:
  // `news` is called on the shelf's thread.
  ExamShelf(exam::CartExams& exams, std::function<void()> news);
  ~ExamShelf();
  ExamShelf(const ExamShelf&) = delete;
  ExamShelf& operator=(const ExamShelf&) = delete;

  // True: the rows have changed.
  bool listen();
  // Asks for the list anew, and for the pictures of rows that come into sight.
  void fill(ui::ExamsView& view, const std::optional<SweepKey>& shown, bool recording);
  void select(std::uint64_t row) { selected_ = row; }
  // The row of the exam, with this sweep of it chosen. False: there is no such row, or not yet.
  bool select(const SweepKey& key);
  void choose_sweep(int by);  // of the row selected
  void scroll(int by);
  // Of the row: its exam and the sweep chosen in it.
  std::optional<SweepKey> key_of(std::uint64_t row) const;
  std::filesystem::path file_of(std::uint64_t row) const;
  void open(const SweepKey& key);
  std::optional<OpenedSweep> take_opened();
  bool opening() const;

 private:
  struct Row {
    std::uint64_t id = 0;
    exam::ExamSummary exam;
    std::string when;
    int sweep = 0;  // chosen, from 1
    bool recovered = false;
  };
  struct Job {
    SweepKey key;
    std::filesystem::path file;
    bool open = false;  // else its card
  };
  void serve();
  SweepCard read_card(const Job& job) const;
  static OpenedSweep read_sweep(const Job& job);
  const Row* find(std::uint64_t row) const;
  void forget_cards(const std::string& exam);  // it has grown
  std::shared_ptr<const SweepCard> card(const Row& row);

  exam::CartExams& exams_;
  std::function<void()> news_;
  std::shared_ptr<const std::vector<exam::ExamSummary>> list_;
  std::vector<Row> rows_;
  std::map<std::string, std::uint64_t> ids_;  // of rows, the same as long as the program runs
  std::uint64_t selected_ = 0;
  int first_ = 0;
  std::vector<ui::ExamView> views_;                            // lent
  std::vector<std::shared_ptr<const SweepCard>> cards_shown_;  // what they borrow

  mutable std::mutex mutex_;  // held for moments, never while the disk works
  std::condition_variable wake_;
  std::deque<Job> jobs_;
  std::map<SweepKey, std::shared_ptr<const SweepCard>> cards_;  // null: asked for
  std::optional<OpenedSweep> opened_;
  int opening_ = 0;
  bool news_waits_ = false;
  bool ending_ = false;
  std::uint64_t pictures_ = 0;
  std::thread thread_;
};

}  // namespace sonoband
