// Exports, and taking disks away, on a thread of their own: the screen asks and looks how far they are. It
// never waits for a disk.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/exchange/exam_export.h"
#include "app/exchange/removable.h"
#include "ui/view.h"

namespace sonoband {

struct ExporterSettings {
  std::filesystem::path folder;  // offered besides sticks and cards; empty: none is
  exchange::MediaSources media;
};

struct ExportJob {
  std::filesystem::path exam;
  exchange::ExamExport what;
  // True once what the operator has made of the exam is on the disk. Asked on the exporter's thread.
  std::function<bool()> saved;
};

class Exporter {
 public:
  // `news` is called on the exporter's thread.
  Exporter(ExporterSettings settings, std::function<void()> news);
  ~Exporter();  // stops what runs
  Exporter(const Exporter&) = delete;
  Exporter& operator=(const Exporter&) = delete;

  // One at a time: false while another runs.
  bool start(ExportJob job);
  bool take_away(exchange::Place place);
  void cancel() { stop_ = true; }
  void look();  // which places there are, anew
  // What has come of the last job is no longer news.
  void forget();

  struct State {
    ui::ExportPhase phase = ui::ExportPhase::idle;
    int permille = 0;
    int files = 0;
    std::string where;
    std::string sentence;
    std::vector<exchange::Place> places;  // those that can be pulled first
    std::uint64_t version = 0;            // of all but `permille`
  };
  State state() const;
  std::uint64_t version() const { return version_.load(std::memory_order_relaxed); }
  int permille() const { return permille_.load(std::memory_order_relaxed); }

 private:
  void serve();
  void export_now(const ExportJob& job);
  void look_now();
  template <class Change>
  void tell(const Change& change);

  const ExporterSettings settings_;
  const std::function<void()> news_;
  std::atomic<bool> stop_{false};
  std::atomic<int> permille_{0};
  std::atomic<std::uint64_t> version_{0};

  mutable std::mutex mutex_;  // held for moments, never while a disk works
  std::condition_variable wake_;
  State state_;
  std::optional<ExportJob> job_;
  std::optional<exchange::Place> leaving_;
  bool look_ = false;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace sonoband
