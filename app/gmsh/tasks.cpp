// SPDX-License-Identifier: Apache-2.0
// The module's one entry (app/input/gmsh_tasks.hpp says what the tasks are).
#include <gmsh.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "app/gmsh/board.hpp"
#include "app/gmsh/model.hpp"

namespace sunder::app {
namespace {

void start() {
  gmsh::initialize(0, nullptr, false);
  gmsh::option::setNumber("General.Terminal", 1);  // errors to stderr: they outlive a crash
}

std::string model() { return "M" + to_bytes(read_model()); }

std::string read(const std::string& path) {
  gmsh::open(path);
  return model();
}

std::string mesh(const std::string& geometry) {
  gmsh::open(geometry);
  gmsh::model::mesh::generate(3);
  return model();
}

std::string board(const std::string& tets, const std::string& thickness) {
  gmsh::option::setNumber("General.Verbosity", 2);  // errors and warnings
  mesh_board(std::strtod(tets.c_str(), nullptr), std::strtod(thickness.c_str(), nullptr));
  return model();
}

std::string convert(const std::string& from, const std::string& to) {
  gmsh::open(from);
  gmsh::write(to);
  return "M";
}

std::string carry_out(const std::string& task, const std::vector<std::string>& given) {
  start();
  if (task == "read") return read(given.at(0));
  if (task == "mesh") return mesh(given.at(0));
  if (task == "board") return board(given.at(0), given.at(1));
  if (task == "convert") return convert(given.at(0), given.at(1));
  return "Eno task \"" + task + "\"";
}

}  // namespace
}  // namespace sunder::app

extern "C" void sunder_gmsh_task(const std::string& task, const std::vector<std::string>& given,
                                 std::string& answer) {
  try {
    answer = sunder::app::carry_out(task, given);
  } catch (const std::string& message) {  // gmsh 4.8 throws strings
    answer = "E" + message;
  }
}
