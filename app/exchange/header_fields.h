// What MetaImage and NRRD headers share: Seq_FrameNNNN_ fields sorted to their frames, and the meaning of the
// sizes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "app/exchange/sequence.h"

namespace sonoband::exchange {

// Takes every field of a header, in order, before the number of frames is known.
class FieldCollector {
 public:
  FieldCollector(std::string file, const SequenceLimits& limits);

  // `line` counts from 1. Throws BadInput at a limit; a frame field whose number cannot be read is left out
  // and counted.
  void add(std::string_view name, std::string_view value, std::int64_t line);

  std::vector<Field>& fields() { return fields_; }

  // Fields of frames that the sizes do not have are left out with a warning.
  std::vector<SequenceFrame> take_frames(std::int64_t count, std::vector<std::string>& warnings);

 private:
  std::string file_;
  std::int64_t max_frames_;
  std::vector<Field> fields_;
  std::vector<SequenceFrame> frames_;
  std::int64_t unreadable_ = 0;
  std::int64_t beyond_ = 0;  // of frames past max_frames_
};

// "Seq_Frame0012_": at least four digits.
std::string frame_prefix(int frame);

struct Layout {
  int components = 1;
  int width = 0;
  int height = 0;
  int slices = 1;
  std::int64_t frames = 1;
  int spatial = 2;  // 2 or 3, of the file's dimensions
};

// `kinds` has one token for each size: domain or space; list or time, last; vector (colour), first. Throws
// BadInput with `file` and the names of the two fields.
Layout layout_of(const std::vector<std::int64_t>& sizes, const std::vector<std::string>& kinds,
                 const std::string& file, const SequenceLimits& limits);

// Bytes of all frames; throws BadInput above the limit. `available` is what the file can hold at most.
std::uint64_t checked_pixel_bytes(const Layout& layout, ElementType type, const std::string& file,
                                  const SequenceLimits& limits);

// Takes the memory; throws BadInput where the machine has not that much.
PixelBuffer take_pixels(std::uint64_t bytes, const std::string& file);

// Mirrors the pixels so that they lie as MF, and sets `orientation`. `code` is as the file has it, empty
// where it has none. Source: IGSIO's orientation codes.
void turn_to_mf(TrackedSequence& sequence, std::string_view code, const std::string& file,
                std::vector<std::string>& warnings);

// For 16-bit and wider samples of the other byte order.
void swap_bytes(TrackedSequence& sequence);

// A field name or value that would be read back as something else; empty: fine. Readers never produce one,
// other makers might.
std::string unwritable(const Field& field, std::string_view forbidden_in_name);

}  // namespace sonoband::exchange
