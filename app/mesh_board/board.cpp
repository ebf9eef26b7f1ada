// SPDX-License-Identifier: Apache-2.0
#include "app/mesh_board/board.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

#include "app/input/nearest.hpp"
#include "app/mesh_board/gmsh_board.hpp"
#include "app/mesh_board/msh_writer.hpp"
#include "app/mesh_board/structured_board.hpp"
#include "app/output/result_file.hpp"
#include "app/system/process.hpp"
#include "app/system/utf8_path.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

constexpr long long kFewestTets = 100;
constexpr long long kMostTets = 50'000'000;
constexpr double kThinnest = 0.1, kThickest = 50.0;  // mm

void check_count(const char* option, std::optional<int> value, int least) {
  constexpr int kMost = 10'000;
  if (!value || (*value >= least && *value <= kMost)) return;
  throw UsageError(std::string(option) + " is " + std::to_string(*value) +
                   "; allowed: " + std::to_string(least) + " to " + std::to_string(kMost));
}

std::string shortest(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

void check(const BoardOptions& options) {
  check_count("--nx", options.nx, 1);
  check_count("--ny", options.ny, 4);  // one row for each volume
  check_count("--nz", options.nz, 1);
  if (!(options.thickness >= kThinnest && options.thickness <= kThickest))
    throw UsageError("--thickness is " + shortest(options.thickness) +
                     "; allowed: " + shortest(kThinnest) + " to " + shortest(kThickest) + " mm");
  const bool counts = options.nx || options.ny || options.nz;
  if (options.tets && counts)
    throw UsageError("--tets and --nx, --ny, --nz are two ways to say the same; give one of them");
  if (options.unstructured && !options.tets)
    throw UsageError("--unstructured needs --tets, the number of tetrahedra to aim at");
  if (options.tets && (*options.tets < kFewestTets || *options.tets > kMostTets))
    throw UsageError("--tets is " + std::to_string(*options.tets) + "; allowed: " +
                     std::to_string(kFewestTets) + " to " + std::to_string(kMostTets));
}

// What is left out makes cells near cubes.
BoardCells chosen_cells(const BoardOptions& options) {
  if (options.tets) return cells_for(*options.tets, options.thickness);
  BoardCells cells;
  constexpr int kDefault = 20;
  const int across = options.nx.value_or(options.ny.value_or(kDefault));
  const int through = static_cast<int>(std::lround(options.thickness / kBoardSide * across));
  cells.nx = options.nx.value_or(across);
  cells.ny = options.ny.value_or(std::max(4, across));
  cells.nz = options.nz.value_or(std::max(1, through));
  if (cells.tets() > kMostTets)
    throw UsageError("--nx, --ny and --nz make " + std::to_string(cells.tets()) +
                     " tetrahedra; allowed: up to " + std::to_string(kMostTets));
  return cells;
}

const std::vector<std::string>& writable_extensions() {
  static const std::vector<std::string> extensions = {".msh", ".vtk", ".mesh", ".unv", ".bdf"};
  return extensions;
}

void check_file(const std::filesystem::path& file, bool ascii) {
  const auto& known = writable_extensions();
  if (std::find(known.begin(), known.end(), file.extension().string()) == known.end())
    throw UsageError("-o " + file.string() + ": the extension \"" + file.extension().string() +
                     "\" is not one that can be written; allowed: " + quoted_list(known));
  if (ascii && file.extension() != ".msh")
    throw UsageError("--ascii is for .msh alone; -o is " + file.string());
}

// Removes a temporary file when it goes out of scope.
struct Temporary {
  std::filesystem::path path;
  ~Temporary() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

// Beside the target, so that the last step is a rename in one folder.
std::filesystem::path beside(const std::filesystem::path& file, const std::string& extension) {
  return file.parent_path() / (".sunder-" + std::to_string(system::process_id()) + extension);
}

void write_through_gmsh(const std::string& msh, const std::filesystem::path& file) {
  const Temporary from{beside(file, ".msh")};
  const Temporary to{beside(file, file.extension().string())};
  write_file(from.path, msh);
  convert_with_gmsh(from.path, to.path);
  std::error_code code;
  std::filesystem::rename(to.path, file, code);
  if (code) throw OutputError("cannot write " + file.string() + ": " + code.message());
}

}  // namespace

Mesh make_board(const BoardOptions& options, BoardReport* report) {
  check(options);
  BoardReport made;
  Mesh mesh;
  if (options.unstructured) {
    mesh = unstructured_board(*options.tets, options.thickness);
    order_by_volume(mesh);
  } else {
    const BoardCells cells = chosen_cells(options);
    mesh = structured_board(cells, options.thickness);
    made = {0, 0, cells.nx, cells.ny, cells.nz};
  }
  made.nodes = mesh.node_count();
  made.tets = mesh.tet_count();
  if (report) *report = made;
  return mesh;
}

BoardReport write_board(const BoardOptions& options, const std::filesystem::path& file) {
  check_file(file, options.ascii);
  BoardReport report;
  const Mesh mesh = make_board(options, &report);
  const bool direct = file.extension() == ".msh";
  const std::string msh = to_msh(mesh, options.ascii);
  if (direct)
    write_file(file, msh);
  else
    write_through_gmsh(msh, file);
  return report;
}

void remove_half_written(const std::filesystem::path& file) {
  std::error_code ignored;
  for (const std::filesystem::path& path :
       {system::utf8_path(temporary_name(file.string())), beside(file, ".msh"),
        system::utf8_path(temporary_name(beside(file, ".msh").string())),
        beside(file, file.extension().string())})
    std::filesystem::remove(path, ignored);
}

}  // namespace sunder::app
