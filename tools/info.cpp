#include "tools/verbs.h"

namespace sonoband::tools {

void add_info(CLI::App& tool) {
  tool.add_subcommand("info", "What a tracked sequence holds");
}

}  // namespace sonoband::tools
