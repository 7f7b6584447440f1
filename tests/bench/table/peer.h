// The peer a table compares with; built only where it is installed (SONOBAND_PEERS).
#pragma once

#include <memory>
#include <string>

#include "core/reslice/band.h"
#include "tests/bench/table/voxel_array.h"

namespace sonoband::bench {

class Peer {
 public:
  virtual ~Peer() = default;
  virtual std::string name() const = 0;
  // Renders the slab anew from the ready array; the picture lives until the next call.
  virtual ConstPixels render(const ReslicePlane& plane, const RenderSettings& settings) = 0;
};

// Borrows the array. Null where no peer was built in.
std::unique_ptr<Peer> make_peer(const VoxelArray& array, int threads);

}  // namespace sonoband::bench
