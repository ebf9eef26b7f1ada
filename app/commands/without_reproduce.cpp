// SPDX-License-Identifier: Apache-2.0
// In place of reproduce.cpp in a build without gmsh (SUNDER_GMSH=OFF).
#include "app/commands/commands.hpp"
#include "sunder/error.hpp"

namespace sunder::app {

int reproduce_paper(const ReproduceArguments&, Interruption&) {
  throw Error(1,
              "sunder reproduce makes its meshes by gmsh, which this build has not "
              "(SUNDER_GMSH=OFF); it runs in a build for Linux");
}

}  // namespace sunder::app
