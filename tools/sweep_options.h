// Which recording, in which frame, which of its frames and pixels: options shared by the verbs that render.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/exchange/sweep_from_sequence.h"
#include "tools/argument_checks.h"

namespace sonoband::tools {

struct SweepOptions {
  std::filesystem::path sequence;
  std::vector<std::filesystem::path> calibrations;
  std::string world;
  std::string frames;  // A-B
  std::string clip;    // X,Y,W,H
  std::string mask = "auto";
  exchange::ColourUse colour = exchange::ColourUse::grey;
  std::string towards, away;  // R,G,B R,G,B ..., from dark to bright; empty: the usual bar's
};

std::shared_ptr<SweepOptions> add_sweep_options(CLI::App& verb);

// --colour and the scanner's colour bar (--towards, --away), for verbs whose output can show colour; without
// them it is rendered as grey.
void add_colour_option(CLI::App& verb, const std::shared_ptr<SweepOptions>& options);

// Throws CLI::ValidationError for what is no colour.
doppler::ColourBar colour_bar(const SweepOptions& options);

// Wrong usage that can be seen before anything is read.
void check_sweep_options(const SweepOptions& options);

// The recording and its calibrations, for check_files_apart.
std::vector<NamedFile> files_read(const SweepOptions& options);

// Reads the recording and its calibration; prints each warning. Throws BadInput, or CLI::ValidationError for
// options that make no sense.
exchange::SequenceSweep load_sweep(const SweepOptions& options);

// {used, left_out: {cause: n}, world, links}
nlohmann::ordered_json frames_json(const exchange::SequenceSweep& sweep);

// A line of progress on a terminal, nothing elsewhere. Work in one piece (all = 1) shows no percentage.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();  // clears the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(int done, int all);

 private:
  std::string what_;
  bool terminal_;
  int last_percent_ = -1;
};

}  // namespace sonoband::tools
