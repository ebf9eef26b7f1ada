// SPDX-License-Identifier: Apache-2.0
// Options of all commands, as texts; they are checked when a command is carried out.
#pragma once

#include <CLI/App.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sunder::app {

class Interruption;

struct Options {
  using Text = std::optional<std::string>;
  // run and plan
  std::string scene;
  Text out, backend, device, route, update, precision, steps, snapshots;
  std::vector<std::string> set;
  bool series = false, quiet = false, measure = false;
  // sweep
  std::vector<std::string> vary;
  Text jobs, part;
  bool merge = false, resume = false;
  // view
  Text frames, script, size;
  bool headless = false;
  // reproduce
  bool quick = false;
  // mesh board
  Text nx, ny, nz, tets, thickness;
  std::string mesh_file;
  bool unstructured = false, ascii = false;
  // help
  std::vector<std::string> help_path;
};

void add_commands(CLI::App& app, Options& options);

/// Carries out the command that was parsed, other than help. Throws UsageError for values that are
/// not allowed.
int carry_out(const CLI::App& app, const Options& options, Interruption& interruption);

}  // namespace sunder::app
