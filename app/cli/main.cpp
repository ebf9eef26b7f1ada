// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command_line.hpp"

int main(int argc, char** argv) { return sunder::app::command_line(argc, argv); }
