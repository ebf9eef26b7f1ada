// SPDX-License-Identifier: Apache-2.0
#include "app/sweep/variants.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "app/input/mesh_import.hpp"
#include "app/input/scene_toml.hpp"
#include "app/system/utf8_path.hpp"
#include "sunder/same_stiffness.hpp"

namespace sunder::app::sweep {
namespace {

// Values of an axis that are made problems beforehand; of more of them those behind are read only.
constexpr std::size_t kMostProblems = 1000;

void check_backend(const Scene& scene) {
  const std::string& name = scene.solver.backend;
  if (name == "auto" || name == "cpu") return;
  throw DeviceError("a sweep computes by backend cpu, not by " + in_quotes(name) +
                    "; use backend cpu or auto, or `sunder run`");
}

/// FNV-1a over the bytes of nodes, elements and their volumes.
std::uint64_t fingerprint(const Mesh& mesh) {
  std::uint64_t hash = 14695981039346656037U;
  const auto take = [&hash](const auto& list) {
    for (const std::byte b : std::as_bytes(std::span(list))) {
      hash = (hash ^ static_cast<std::uint64_t>(b)) * 1099511628211U;
    }
  };
  take(mesh.nodes);
  take(mesh.tets);
  take(mesh.volume_of);
  for (const NamedVolume& volume : mesh.volumes) take(volume.name);
  return hash;
}

}  // namespace

Variants::Variants(std::filesystem::path scene, std::vector<std::string> overrides,
                   std::vector<Axis> axes)
    : scene_(std::move(scene)),
      overrides_(std::move(overrides)),
      axes_(std::move(axes)),
      text_(scene_text(scene_)) {}

std::shared_ptr<const Mesh> Variants::mesh(const std::string& path) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<const Mesh>& mesh = meshes_[path];
  if (!mesh) {
    mesh = std::make_shared<const Mesh>(
        import_mesh(scene_.parent_path() / system::utf8_path(path), &warnings_));
  }
  return mesh;
}

std::vector<std::string> Variants::warnings() const {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

std::vector<std::string> Variants::fingerprints() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> all;
  for (const auto& [path, mesh] : meshes_) {
    all.push_back(path + " " + std::to_string(fingerprint(*mesh)));
  }
  return all;
}

void Variants::read(const std::vector<std::size_t>& places) const {
  static_cast<void>(parse_scene(text_, scene_.string(), overrides_, overrides_at(axes_, places)));
}

std::shared_ptr<const Problem> Variants::problem(const std::vector<std::size_t>& places) {
  ParsedScene parsed = parse_scene(text_, scene_.string(), overrides_, overrides_at(axes_, places));
  refuse_played(parsed);
  parsed.scene.mesh = *mesh(parsed.mesh_path);
  // Preparing fractures shortens single frames; of many runs it only adds to the work.
  parsed.scene.solver.prepare = false;
  try {
    return std::make_shared<const Problem>(std::move(parsed.scene));
  } catch (const InputError& error) {
    throw parsed.places.located(error);
  }
}

Checked check_values(Variants& variants) {
  const std::vector<Axis>& axes = variants.axes();
  std::vector<std::size_t> places(axes.size(), 0);
  Checked checked;
  checked.first = variants.problem(places);
  check_backend(checked.first->scene());
  checked.instruments = static_cast<int>(checked.first->scene().instruments.size());
  checked.changes_body.assign(axes.size(), false);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    for (places[a] = 1; places[a] < axes[a].values.size(); ++places[a]) {
      if (places[a] >= kMostProblems) {
        variants.read(places);
        continue;
      }
      const auto problem = variants.problem(places);
      check_backend(problem->scene());
      const int instruments = static_cast<int>(problem->scene().instruments.size());
      checked.instruments = std::max(checked.instruments, instruments);
      if (!same_stiffness(*checked.first, *problem)) checked.changes_body[a] = true;
    }
    places[a] = 0;
  }
  return checked;
}

}  // namespace sunder::app::sweep
