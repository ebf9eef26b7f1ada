// SPDX-License-Identifier: Apache-2.0
#include <csignal>

#include "app/cli/command_line.hpp"
#include "app/commands/interruption.hpp"

int main(int argc, char** argv) {
  // A file over the size limit is an error of that write (EFBIG), not the program's end.
  std::signal(SIGXFSZ, SIG_IGN);
  sunder::app::Interruption interruption;
  const int exit_code = sunder::app::command_line(argc, argv, interruption);
  interruption.over(exit_code);
  return exit_code;
}
