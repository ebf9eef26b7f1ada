// SPDX-License-Identifier: Apache-2.0
// The scene reader on any text: a scene or an InputError, nothing else. Behind a line "%%" come
// --set texts, one a line. What is read is made a Problem on a board of two elements, so that the
// checks behind the reader are exercised as well.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "app/input/scene_toml.hpp"
#include "sunder/error.hpp"

namespace {

using sunder::Mesh;

// Two tetrahedra on a common face, in the volumes "lower" and "upper".
Mesh small_mesh() {
  Mesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.tets = {{0, 1, 2, 3}, {0, 2, 1, 4}};
  mesh.volume_of = {0, 1};
  mesh.volumes = {{"lower", 1}, {"upper", 2}};
  mesh.surfaces = {{"base", 3, {{0, 2, 1}}}};
  return mesh;
}

void check_message(const sunder::Error& error) {
  const std::string_view message = error.what();
  if (message.empty() || message.find('\n') != std::string_view::npos) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string text(size, '\0');
  if (size > 0) std::memcpy(text.data(), data, size);
  std::vector<std::string> overrides;
  if (const std::size_t mark = text.find("\n%%\n"); mark != std::string::npos) {
    std::string_view rest = std::string_view(text).substr(mark + 4);
    while (!rest.empty() && overrides.size() < 8) {
      const std::size_t end = rest.find('\n');
      overrides.emplace_back(rest.substr(0, end));
      rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    }
    text.resize(mark);
  }
  try {
    sunder::app::ParsedScene parsed = sunder::app::parse_scene(text, "fuzz.toml", overrides);
    parsed.scene.mesh = small_mesh();
    try {
      const sunder::Problem problem(std::move(parsed.scene));
    } catch (const sunder::InputError& error) {
      check_message(parsed.places.located(error));
    }
  } catch (const sunder::InputError& error) {
    check_message(error);
  }
  return 0;
}
