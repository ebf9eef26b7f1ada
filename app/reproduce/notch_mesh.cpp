// SPDX-License-Identifier: Apache-2.0
#include "app/reproduce/notch_mesh.hpp"

#include <filesystem>
#include <stdexcept>

#include "app/input/child_process.hpp"
#include "app/input/gmsh_tasks.hpp"
#include "app/input/msh_reader.hpp"
#include "app/input/raw_mesh.hpp"
#include "app/output/result_file.hpp"
#include "app/output/text.hpp"
#include "app/reproduce/paper_files.hpp"
#include "app/system/process.hpp"
#include "app/system/utf8_path.hpp"
#include "sunder/error.hpp"

namespace sunder::app::reproduce {
namespace {

std::filesystem::path temporary_file() {
  return std::filesystem::temp_directory_path() /
         ("sunder-reproduce-" + std::to_string(system::process_id()) + ".geo");
}

/// A geometry that gmsh can open; gone with the object.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string_view text) : path_(temporary_file()) {
    write_file(path_, text);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void replace_once(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos)
    throw std::logic_error("the board's geometry does not hold \"" + from + "\" once");
  text.replace(at, from.size(), to);
}

std::shared_ptr<const Mesh> mesh_of_geometry(const std::string& text) {
  const TemporaryFile geometry(text);
  ChildLimits limits;
  limits.timeout = std::chrono::minutes(2);
  const ChildOutcome outcome =
      run_in_child([&] { return gmsh_task("mesh", {geometry.path().string()}); }, limits);
  const bool done = outcome.end == ChildOutcome::End::done && outcome.result.starts_with('M');
  const auto raw =
      done ? from_bytes(std::string_view(outcome.result).substr(1)) : std::optional<RawMesh>();
  if (!raw)
    throw Error(1, "gmsh failed to mesh the board: " +
                       (outcome.result.empty() ? outcome.error_text : outcome.result.substr(1)));
  return std::make_shared<const Mesh>(to_mesh(*raw, "board", nullptr));
}

}  // namespace

std::string notch_geometry(const NotchMesh& wanted) {
  std::string text(paper_file("meshes/board1954_notch.geo"));
  replace_once(text, "h=3.939;", "h=" + number(wanted.size) + ";");
  replace_once(text, "a0=4.04;", "a0=" + number(wanted.length) + ";");
  replace_once(text, "Mesh.Algorithm=5;",
               "Mesh.Algorithm=" + std::to_string(wanted.plane_mesher) + ";");
  return text;
}

std::string board_geometry(const BoardMesh& wanted) {
  std::string text(paper_file("meshes/board1954.geo"));
  replace_once(text, "h=3.823;", "h=" + number(wanted.size) + ";");
  replace_once(text, "Mesh.Algorithm=5;",
               "Mesh.Algorithm=" + std::to_string(wanted.plane_mesher) + ";");
  return text;
}

std::shared_ptr<const Mesh> mesh_notch(const NotchMesh& wanted) {
  return mesh_of_geometry(notch_geometry(wanted));
}

std::shared_ptr<const Mesh> mesh_board(const BoardMesh& wanted) {
  return mesh_of_geometry(board_geometry(wanted));
}

void remove_temporary_files() {
  std::error_code ignored;
  const std::filesystem::path path = temporary_file();
  std::filesystem::remove(path, ignored);
  std::filesystem::remove(system::utf8_path(temporary_name(path.string())), ignored);
}

Mesh read_embedded_mesh(const std::string& file) {
  return to_mesh(read_msh(paper_file(file), file), file, nullptr);
}

}  // namespace sunder::app::reproduce
