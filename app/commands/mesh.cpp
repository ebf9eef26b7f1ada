// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include "app/commands/commands.hpp"
#include "app/output/text.hpp"

namespace sunder::app {

int mesh_board(const BoardArguments& arguments, Interruption& interruption) {
  const Expecting writing(interruption, {arguments.file.string() + " was not written",
                                         [file = arguments.file] {
                                           remove_half_written(file);
                                           return true;
                                         },
                                         {},
                                         {}});
  const BoardReport report = write_board(arguments.options, arguments.file);
  interruption.over(0);
  std::cout << arguments.file.string() << ": " << grouped(report.tets) << " tetrahedra"
            << ", " << counted(report.nodes, "node");
  if (report.nx > 0)
    std::cout << ", " << report.nx << " x " << report.ny << " x " << report.nz << " cells";
  std::cout << "\n";
  return 0;
}

}  // namespace sunder::app
