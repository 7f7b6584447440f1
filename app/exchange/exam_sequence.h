// A sweep of an exam as a tracked sequence, and back.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/exam/exam_reader.h"
#include "app/exam/exam_writer.h"
#include "app/exchange/plus_config.h"
#include "app/exchange/progress.h"
#include "app/exchange/sequence.h"

namespace sonoband::exchange {

struct ExportedSweep {
  TrackedSequence sequence;         // grey bytes, or Doppler keys as they are
  exam::SweepSetup setup;           // its mask does not fit a sequence: it goes into a picture beside
  std::vector<std::string> damage;  // frames that are left out, one sentence each
};

// Every frame of the sweep, with a pose or without: ImageTo<World>Transform bit for bit, ProbeTo<World> where
// it was stored, Timestamp (after the latency offset), UnfilteredTimestamp, and what only we read in fields
// that begin with Sonoband. No label of a patient. The tracker's raw readings stay in the exam. Throws
// exam::StoreError, BadInput.
ExportedSweep sequence_from_exam(const exam::ExamReader& exam, std::int64_t sweep,
                                 const Progress& progress = {});

// PLUS configuration with ImageToProbe, for readers that look for the calibration there; empty: none stored.
std::string plus_config_xml(const exam::SweepSetup& setup);

// Adds the sequence to the exam as its next sweep; gives what was left out or assumed, one sentence each.
// Frames without a usable pose are kept, without one. `mask` (of the pictures' size, or empty) counts besides
// what the configuration says. Throws exam::StoreError, BadInput.
std::vector<std::string> sequence_into_exam(ReadSequence&& read, const PlusConfig& config, Pixels mask,
                                            const std::string& file, exam::ExamWriter& exam,
                                            const Progress& progress = {});

}  // namespace sonoband::exchange
