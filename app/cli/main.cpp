// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "app/cli/command_line.hpp"
#include "app/commands/interruption.hpp"
#include "app/system/process.hpp"

int main(int argc, char** argv) {
  const std::vector<std::string> words = sunder::app::system::start_process(argc, argv);
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  sunder::app::Interruption interruption;
  const int exit_code =
      sunder::app::command_line(static_cast<int>(pointers.size()), pointers.data(), interruption);
  interruption.over(exit_code);
  return exit_code;
}
