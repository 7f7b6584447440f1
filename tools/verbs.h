// The verbs of sonoband-tool. Each adds its own subcommand, with help and a callback, in the file of its
// name.
//
// A callback reports bad input by throwing BadInput: one sentence that names the place and the cure; main
// prints it and exits 1. Wrong usage is CLI11's to report: exit 2.
#pragma once

#include <CLI/CLI.hpp>

namespace sonoband::tools {

void add_info(CLI::App& tool);
void add_convert(CLI::App& tool);
void add_render(CLI::App& tool);
void add_manifold(CLI::App& tool);
void add_flow(CLI::App& tool);
void add_voxels(CLI::App& tool);
void add_exams(CLI::App& tool);
void add_export(CLI::App& tool);
void add_places(CLI::App& tool);
void add_import(CLI::App& tool);
void add_verify(CLI::App& tool);
void add_send(CLI::App& tool);
void add_serve(CLI::App& tool);

// The whole program: 0 success, 1 bad input, 2 wrong usage.
int run_tool(int argc, const char* const* argv);

}  // namespace sonoband::tools
