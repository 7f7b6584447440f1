#include <cstdio>
#include <exception>
#include <string>

#include "app/bad_input.h"
#include "tools/argument_checks.h"
#include "tools/verbs.h"

namespace sonoband::tools {

namespace {

// What a file holds may be part of a sentence; a terminal must not obey it.
std::string printable(std::string text) {
  for (char& c : text)
    if (const auto byte = static_cast<unsigned char>(c); byte < 0x20 || byte == 0x7f) c = '?';
  return text;
}

}  // namespace

int run_tool(int argc, const char* const* argv) {
  CLI::App tool{"Tracked ultrasound sequences: look at them, render them, convert them. Research use only.",
                "sonoband-tool"};
  tool.require_subcommand(1);
  add_info(tool);
  add_render(tool);
  add_manifold(tool);
  add_flow(tool);
  add_voxels(tool);
  add_convert(tool);
  add_exams(tool);
  add_export(tool);
  add_places(tool);
  add_import(tool);
  add_verify(tool);
  add_send(tool);
  add_serve(tool);
  for (CLI::App* verb : tool.get_subcommands([](const CLI::App*) { return true; }))
    refuse_empty_values(*verb);
  try {
    tool.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return tool.exit(e) == 0 ? 0 : 2;
  } catch (const BadInput& e) {
    std::fprintf(stderr, "sonoband-tool: %s\n", printable(e.what()).c_str());
    return 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "sonoband-tool: unexpected: %s\n", printable(e.what()).c_str());
    return 1;
  }
  return 0;
}

}  // namespace sonoband::tools
