// The PLUS configuration reader, the mask and the graph that are made of it: no crash, no hang.
#include <cstdint>
#include <string_view>

#include "app/bad_input.h"
#include "app/exchange/plus_config.h"
#include "app/exchange/transform_graph.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sonoband;
  try {
    const auto config = exchange::parse_plus_config({reinterpret_cast<const char*>(data), size}, "fuzz.xml");
    exchange::TransformGraph graph;
    graph.add(config.transforms);
    for (const std::string& frame : graph.frames()) {
      try {
        graph.find(frame, "Image");
      } catch (const BadInput&) {
        continue;
      }
    }
    exchange::sector_mask(40, 30, config.clip, std::nullopt, config.fan, "fuzz");
  } catch (const BadInput&) {
    return 0;
  }
  return 0;
}
