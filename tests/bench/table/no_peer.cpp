#include "tests/bench/table/peer.h"

namespace sonoband::bench {

std::unique_ptr<Peer> make_peer(const VoxelArray&, int) {
  return nullptr;
}

}  // namespace sonoband::bench
