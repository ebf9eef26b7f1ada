// SPDX-License-Identifier: Apache-2.0
#include "app/mesh_board/gmsh_board.hpp"

#include "app/input/child_process.hpp"
#include "app/input/gmsh_tasks.hpp"
#include "app/input/raw_mesh.hpp"
#include "sunder/error.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

// The child's answer behind its first byte; 'E' means that gmsh said no.
std::string answer(const ChildOutcome& outcome, const std::string& task) {
  if (outcome.end != ChildOutcome::End::done || outcome.result.empty())
    throw Error(1, "gmsh failed to " + task);
  if (outcome.result[0] == 'E')
    throw Error(1, "gmsh failed to " + task + ": " + outcome.result.substr(1));
  return outcome.result.substr(1);
}

}  // namespace

Mesh unstructured_board(long long tets, double thickness) {
  ChildLimits limits;
  limits.timeout = std::chrono::milliseconds(120'000 + tets);  // some 10^5 tetrahedra a second
  limits.memory_bytes = (std::size_t{4} << 30U) + static_cast<std::size_t>(tets) * 4096;
  const ChildOutcome outcome = run_in_child(
      [&] {
        return gmsh_task("board", {std::to_string(tets), in_digits(thickness)});
      },
      limits);
  const auto raw = from_bytes(answer(outcome, "mesh the board"));
  if (!raw) throw Error(1, "gmsh's answer is incomplete");
  return to_mesh(*raw, "board", nullptr);
}

void convert_with_gmsh(const std::filesystem::path& from, const std::filesystem::path& to) {
  ChildLimits limits;
  limits.timeout = std::chrono::minutes(10);
  limits.memory_bytes = std::size_t{16} << 30U;
  const auto convert = [&] { return gmsh_task("convert", {from.string(), to.string()}); };
  answer(run_in_child(convert, limits), "write " + to.string());
}

}  // namespace sunder::app
