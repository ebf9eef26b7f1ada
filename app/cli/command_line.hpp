// SPDX-License-Identifier: Apache-2.0
// The command line of the program: commands, options, exit codes (docs/interface.md).
#pragma once

namespace sunder::app {

class Interruption;

/// Runs the program and returns its exit code. Nothing escapes: every error becomes one sentence
/// on stderr.
int command_line(int argc, const char* const* argv, Interruption& interruption);

}  // namespace sunder::app
