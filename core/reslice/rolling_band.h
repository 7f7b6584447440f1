// A band that is dragged along its normal or made thicker and thinner: layers once painted are kept, so that
// a step costs the layers that are new and a few passes over the picture.
//
// Layers are painted in blocks of `block_layers`, counted from the first picture's middle, all of a block in
// one go: a layer alone costs ten times its share. The block that comes next in the direction of a drag is
// painted ahead, a portion with every step, so that steps cost the same.
//
// Maxima (or minima) are kept of every run of 2, 4, 8 ... layers that begins at a multiple of its length, as
// far as they were needed; any band is at most 2 log2 N such runs. A band that becomes thicker is the one
// before and the layers about it: such nested pictures are kept, and a thinner band finds its own again. How
// many layers have data, and the sums of a mean, are whole numbers: a layer that comes is added, one that
// goes is taken off.
#pragma once

#include <bit>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "core/reslice/lattice.h"
#include "core/reslice/layer_block.h"
#include "core/reslice/prepared_sweep.h"

namespace sonoband {

// While the plane moves by whole steps along its normal (a step's 1/1000 is allowed for rounding) or the
// thickness changes, a layer has the same bits however the band got there, and the picture is, to the last
// bit, its layers compounded; each is render_planar's thin picture but for ties, and the whole so
// render_planar's. The first picture of a plane, and one whose compounding alone differs, is render_planar's
// itself: layers are painted when the band first moves, in the time of four to six such pictures.
//
// Memory: up to 2 1/8 bytes per pixel and layer kept, of at most 1.5 N + 46 layers (N + 62 of thin bands),
// and 59 per pixel: 14 mm of 640x480 hold 117 MB at most.
class RollingBand {
 public:
  // Means of Doppler pictures are rendered whole: their sums are not kept.
  // `stop` is heeded by whole pictures; a step is short.
  BandImage render(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
                   Parallel& parallel, const StopFlag* stop = nullptr);

  // Paints the layers of the plane's band that are missing, then the blocks beside it, so that the next
  // render() of it, or of a plane a few steps on, finds them. Ends between portions once `stop` is set; what
  // is painted by then is kept. True: all are there, or no layers are kept of such a picture.
  bool prepare(PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
               Parallel& parallel, const StopFlag* stop = nullptr);
  // Layers that render() would have to paint, with all of their blocks; empty: it would paint the whole
  // picture by render_planar.
  std::optional<int> layers_missing(const PreparedSweep& sweep, const ReslicePlane& plane,
                                    const RenderSettings& settings) const;
  // The most that bytes() can become while the plane is dragged.
  static std::size_t most_bytes(const ReslicePlane& plane, const RenderSettings& settings);

  static constexpr int block_layers = LayerBlock::most_layers;
  // Pictures of thinner bands that are kept while a band grows.
  static constexpr std::size_t most_nested = 16;
  // Layers painted since the last whole picture, of blocks that are complete, for statistics.
  int layers_painted() const { return layers_painted_; }
  // Of all pictures and sums kept.
  std::size_t bytes() const;
  // Forgets all layers and gives back their memory.
  void clear();

 private:
  struct Block {
    LayerBlock layers;
    int strips = 0;  // painted
  };
  struct Layer {
    const LayerBlock* block = nullptr;
    int index = 0;  // in the block
  };
  // Some layers of a block, by their bits.
  struct Marks {
    const LayerBlock* block = nullptr;
    std::uint16_t layers = 0;
  };
  // Strips of a block to be painted by one thread.
  struct Portion {
    int block = 0, first = 0, strips = 0;
  };
  // Of layers first .. first + 2^level - 1.
  struct Run {
    int level = 0, first = 0;
    // clang-tidy 14 takes the zero that its parts are compared with for a pointer.
    auto operator<=>(const Run&) const = default;  // NOLINT(modernize-use-nullptr)
  };
  struct Window {
    int first = 0, last = -1;
    bool empty() const { return last < first; }
    bool holds(int layer) const { return layer >= first && layer <= last; }
    bool holds(const Window& other) const { return holds(other.first) && holds(other.last); }
    bool operator==(const Window&) const = default;
  };
  // A band's extremes.
  struct Nested {
    Window band;
    Pixels extremes;
  };
  // A run from its halves.
  struct Build {
    ConstPixels first, second;
    Pixels* both = nullptr;
  };
  // From the last picture to the next.
  struct Step {
    std::vector<Build> builds;
    std::vector<ConstPixels> parts;  // whose extremes are the picture
    Pixels* grown = nullptr;         // where they are kept as well
    std::vector<Marks> marks_come, marks_gone;
    std::vector<ConstPixels> values_come, values_gone;  // of a mean
  };

  // The block that holds a layer; layers may be negative.
  static int block_of(int layer) {
    static_assert((block_layers & (block_layers - 1)) == 0);
    return layer >> std::countr_zero(static_cast<unsigned>(block_layers));
  }
  static Window window_of(int offset, const RenderSettings& settings);
  std::shared_ptr<const FrameTable> table_of(PreparedSweep& sweep);
  int strips_left(int block) const;
  void move_to(int offset, const RenderSettings& settings, Parallel& parallel);
  bool follows(const PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings,
               int& offset) const;
  void begin(const PreparedSweep& sweep, const ReslicePlane& plane, const RenderSettings& settings);
  Lattice lattice_of_block(int block) const;
  void add_portions(int block, int strips, int count, std::vector<Portion>& portions);
  // Paints portion i of several; they may be painted in any order and on any threads.
  std::function<void(int)> painter_of(const FrameTable& table, const std::vector<Portion>& portions);
  void paint_missing(const FrameTable& table, const Window& band, Parallel& parallel);
  std::vector<Portion> portions_ahead(const Window& before, const Window& band, bool first, int threads);
  void fill_gaps(std::uint8_t missing, Parallel& parallel);
  void forget_far(const Window& band);
  void forget();
  Pixels take_run();
  void give_back(Pixels pixels);
  Layer layer(int index) const;
  std::vector<Run> runs_of(const Window& band) const;
  int unbuilt(const Run& run) const;
  void need(const Run& run, std::vector<Run>& to_build);
  void add_parts(const Run& run, int& room, std::vector<Run>& to_build, std::vector<Run>& parts);
  Window keep_nested(const Window& band, const Window& before);
  void forget_nested();
  std::vector<Marks> marks_of(const std::vector<int>& layers) const;
  ConstPixels pixels_of(const Run& run) const;
  Step next_step(const Window& band);
  void compound_row(const Step& step, int y, BandImage& image);
  // Portions of layers that are not the band's are painted on the way: threads wait for one another once.
  BandImage compound(const Window& band, Parallel& parallel, int portions = 0,
                     const std::function<void(int)>& paint_portion = {});

  ReslicePlane plane_;  // of layer 0; layer i lies i steps along its normal
  RenderSettings settings_;
  std::size_t frames_ = 0;
  bool begun_ = false;
  int offset_ = 0;               // of the last picture's middle layer
  int strips_ = 1;               // of a block
  std::map<int, Block> blocks_;  // block b: layers b block_layers and on
  std::uint8_t missing_ = 0;     // in pixels without data: what never is the extreme
  std::map<Run, Pixels> runs_;   // level 1 and above
  std::vector<Nested> nested_;   // each within the next
  // Of what was forgotten, so that memory need not come anew.
  std::vector<LayerBlock> spare_blocks_;
  std::vector<Pixels> spare_runs_;
  Window counted_;  // whose layers are in counts_ and sums_
  bool summed_ = false;
  ImageBuffer<std::uint16_t> counts_;
  ImageBuffer<std::uint32_t> sums_;
  int layers_painted_ = 0;
  int left_out_ = 0;  // frames, by RenderSettings::thin_dense_frames
};

}  // namespace sonoband
