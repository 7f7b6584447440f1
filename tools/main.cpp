// sonoband-tool: recordings and bands on the command line.
#include "tools/verbs.h"

int main(int argc, char** argv) {
  return sonoband::tools::run_tool(argc, argv);
}
