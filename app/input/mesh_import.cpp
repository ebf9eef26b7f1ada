// SPDX-License-Identifier: Apache-2.0
#include "app/input/mesh_import.hpp"

#include <algorithm>
#include <optional>

#include "app/input/child_process.hpp"
#include "app/input/end_check.hpp"
#include "app/input/file_bytes.hpp"
#include "app/input/gmsh_tasks.hpp"
#include "app/input/msh_reader.hpp"
#include "app/input/nearest.hpp"
#include "app/input/raw_mesh.hpp"
#include "app/input/vtk_check.hpp"
#include "app/input/vtu_reader.hpp"
#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"

namespace sunder::app {
namespace {

constexpr std::size_t kLargestMesh = std::size_t{8} << 30U;  // bytes

// gmsh takes any other file for a script of its own language and would run it.
const std::vector<std::string>& readable_extensions() {
  static const std::vector<std::string> extensions = {".msh", ".vtk", ".vtu", ".mesh",
                                                      ".unv", ".bdf", ".nas"};
  return extensions;
}

std::string lower_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

std::string checked_extension(const std::filesystem::path& path) {
  const std::string extension = lower_extension(path);
  const auto& known = readable_extensions();
  if (std::find(known.begin(), known.end(), extension) == known.end()) {
    throw InputError(InputFault::unreadable_file,
                     path.string() + ": the extension " + in_quotes(extension) +
                         " is not that of a mesh file; allowed: " + quoted_list(known) +
                         (extension == ".inp" ? " (gmsh writes .inp but does not read it: convert "
                                                "it, say by `meshio convert mesh.inp mesh.vtu`)"
                                              : ""));
  }
  return extension;
}

// The last line "Error : ..." that gmsh wrote, without its head.
std::string last_gmsh_error(const std::string& log) {
  const std::size_t begin = log.rfind("Error ");
  if (begin == std::string::npos) return "";
  const std::size_t colon = log.find(':', begin);
  if (colon == std::string::npos) return "";
  std::string text = log.substr(colon + 1, log.find('\n', colon) - colon - 1);
  text.erase(0, text.find_first_not_of(' '));
  while (!text.empty() && (text.back() == ' ' || text.back() == '\r')) text.pop_back();
  return text;
}

std::string in_parentheses(const std::string& gmsh_error) {
  return gmsh_error.empty() ? "" : " (gmsh: " + gmsh_error + ")";
}

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& why,
                       const std::string& gmsh_error) {
  throw InputError(InputFault::unreadable_file,
                   path.string() + ": " + why + in_parentheses(gmsh_error));
}

ChildLimits child_limits(const ImportLimits& limits, std::size_t file_bytes) {
  constexpr std::size_t kMiB = std::size_t{1} << 20U;
  ChildLimits result;
  result.timeout = limits.timeout.count() > 0
                       ? limits.timeout
                       : std::chrono::milliseconds(30'000 + 1'000 * (file_bytes / kMiB));
  result.memory_bytes =
      limits.memory_bytes > 0 ? limits.memory_bytes : 2048 * kMiB + 64 * file_bytes;
  return result;
}

RawMesh read_in_child(const std::filesystem::path& path, const ChildLimits& limits) {
  if (!has_gmsh()) {
    fail(path,
         "this build has no gmsh (SUNDER_GMSH=OFF), which reads this format; save it as .msh or "
         ".vtu",
         "");
  }
  const ChildOutcome outcome =
      run_in_child([&] { return gmsh_task("read", {path.string()}); }, limits);
  const std::string error = last_gmsh_error(outcome.error_text);
  switch (outcome.end) {
    case ChildOutcome::End::timed_out:
      fail(path,
           "reading it took longer than " + std::to_string(limits.timeout.count() / 1000) +
               " s and was stopped",
           error);
    case ChildOutcome::End::out_of_memory:
      fail(path,
           "reading it takes more than " + std::to_string(limits.memory_bytes >> 20U) +
               " MiB of memory",
           error);
    case ChildOutcome::End::crashed:
      fail(path,
           "gmsh crashed while reading it (signal " + std::to_string(outcome.signal) +
               "): the file is damaged or not of the format its name says",
           error);
    case ChildOutcome::End::done:
      break;
  }
  const std::string_view result = outcome.result;
  if (result.starts_with('E')) fail(path, "gmsh cannot read it", std::string(result.substr(1)));
  std::optional<RawMesh> mesh = result.empty() ? std::nullopt : from_bytes(result.substr(1));
  if (!mesh) fail(path, "gmsh's answer is incomplete", error);
  return *std::move(mesh);
}

// What was found without gmsh.
struct Found {
  std::size_t bytes = 0;
  std::optional<RawMesh> mesh;     // of .msh and .vtu: all of it
  std::optional<VtkContents> vtk;  // what gmsh does not hand over
};

VtkContents check_vtk_orders(std::string_view bytes, const std::string& name) {
  VtkContents contents = check_vtk(bytes, name);
  const bool mixed = contents.first_order > 0 && contents.first_order < contents.tetrahedra;
  if (contents.unread == 0 && !mixed) return contents;
  throw InputError(
      InputFault::unreadable_file,
      name + ": has tetrahedra of " +
          (mixed ? "first and of second order, of which gmsh reads one kind only from "
                   ".vtk"
                 : "VTK's type 71 or 78 (Lagrange, Bezier), which gmsh does not read") +
          "; save it as .vtu or .msh, whose corner nodes are used, or all of it as "
          "linear tetrahedra (type 10)");
}

Found read_without_gmsh(const std::filesystem::path& path) {
  const std::string extension = checked_extension(path);
  const std::string bytes = read_file(path, kLargestMesh);
  const std::string name = path.string();
  Found found{bytes.size(), std::nullopt, std::nullopt};
  if (extension == ".msh")
    found.mesh = read_msh(bytes, name);
  else if (extension == ".vtk")
    found.vtk = check_vtk_orders(bytes, name);
  else if (extension == ".vtu")
    found.mesh = read_vtu(bytes, name);
  else
    check_end(bytes, extension, name);
  if (found.vtk && found.vtk->tetrahedra == 0)
    throw InputError(InputFault::no_tetrahedra, name + ": has no tetrahedra");
  return found;
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& path) {
  return std::ranges::find(readable_extensions(), lower_extension(path)) !=
         readable_extensions().end();
}

Mesh import_mesh(const std::filesystem::path& path, std::vector<std::string>* warnings,
                 const ImportLimits& limits) {
  Found found = read_without_gmsh(path);
  if (!found.mesh) found.mesh = read_in_child(path, child_limits(limits, found.bytes));
  if (found.vtk) set_groups_in_order(*found.mesh, found.vtk->tet_tags);
  return to_mesh(*found.mesh, path.string(), warnings);
}

}  // namespace sunder::app
