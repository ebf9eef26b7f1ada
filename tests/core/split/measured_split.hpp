// SPDX-License-Identifier: Apache-2.0
// A crack that splits a body on route factor of the CPU, its K measured where it ends for its
// field; plates in plane strain to put it in.
#pragma once

#include <memory>
#include <vector>

#include "cpu_reference/cpu_reference.hpp"
#include "fracture/field_sif/field_intensity.hpp"
#include "fracture/split/crack_tip_offset.hpp"
#include "split_bodies.hpp"
#include "sunder/simulation.hpp"
#include "support/loads.hpp"

namespace sunder::test {

inline constexpr double kFar = 1e9;  ///< [mm] beyond every body

/// Plane strain: u_z = 0 on both faces. What holds it in its plane is the caller's.
inline Scene plane_strain_plate(Mesh mesh, double poisson) {
  double depth = 0;
  for (const Vec3& x : mesh.nodes) depth = std::max(depth, x.z());
  Scene scene;
  scene.mesh = std::move(mesh);
  scene.materials["board"] = {1.0, poisson, 1e9};
  scene.fracture.model = FractureModel::b;
  scene.fracture.crack = CrackWay::split;
  scene.fracture.alpha = 1e-9;
  scene.solver.route = Route::factor;
  for (double z : {0.0, depth}) {
    scene.supports.push_back(
        {Box{Vec3(-kFar, -kFar, z - 1e-9), Vec3(kFar, kFar, z + 1e-9)}, Axes{4}});
  }
  return scene;
}

/// Forces of a stress on faces of the outline whose nodes `on` takes, shape (3 * nodes): the stress
/// at a face's middle, its share of each node.
inline std::vector<double> traction_of(const Mesh& mesh, const std::function<bool(const Vec3&)>& on,
                                       const std::function<Mat3(const Vec3&)>& stress) {
  std::vector<double> force(3 * mesh.nodes.size(), 0.0);
  for (const FreeFace& face : free_faces(mesh)) {
    const auto takes = [&](Index n) { return on(mesh.nodes[static_cast<std::size_t>(n)]); };
    if (!std::all_of(face.nodes.begin(), face.nodes.end(), takes)) continue;
    const Vec3 a = mesh.nodes[face.nodes[0]], b = mesh.nodes[face.nodes[1]],
               c = mesh.nodes[face.nodes[2]];
    const auto& tet = mesh.tets[static_cast<std::size_t>(face.tet)];
    Vec3 middle = Vec3::Zero();
    for (Index n : tet) middle += mesh.nodes[static_cast<std::size_t>(n)] / 4;
    Vec3 area = (b - a).cross(c - a) / 2;
    if (area.dot(middle - a) > 0) area = -area;  // outward
    const Vec3 part = stress((a + b + c) / 3) * area / 3;
    for (Index n : face.nodes) {
      for (int axis = 0; axis < 3; ++axis)
        force[static_cast<std::size_t>(3 * n + axis)] += part[axis];
    }
  }
  return force;
}

class MeasuredSplit {
 public:
  explicit MeasuredSplit(Scene scene)
      : problem_(std::make_shared<const Problem>(std::move(scene))),
        backend_(cpu_reference::create(problem_, needs_of(*problem_))),
        crack_(*problem_),
        meter_(*problem_, crack_.board) {}

  [[nodiscard]] EdgeSplit& crack() { return crack_; }
  [[nodiscard]] const Problem& problem() const { return *problem_; }
  [[nodiscard]] Backend& backend() { return *backend_; }
  /// What the crack has just opened.
  void follow(const fracture::SplitStep& step) {
    ASSERT_TRUE(step.moved());
    backend_->change(step.change);
  }
  void load(std::vector<double> force, std::vector<double> grips = {}) {
    force_ = std::move(force);
    force_.resize(3 * problem_->mesh().nodes.size(), 0.0);
    grips_ = std::move(grips);
  }
  /// Displacement of all nodes, new ones too.
  [[nodiscard]] std::vector<Vec3> displacement() {
    solve();
    std::vector<Index> nodes(static_cast<std::size_t>(backend_->node_count()));
    std::iota(nodes.begin(), nodes.end(), 0);
    std::vector<Vec3> u(nodes.size());
    backend_->read_displacement(nodes, u);
    return u;
  }
  /// Where a tip ends for its field, and K there.
  struct Found {
    Vec3 tip;
    fracture::IntensityFactors k;
  };
  [[nodiscard]] Found measure(std::size_t tip = 0) {
    solve();
    fracture::FieldView view{crack_.destroyed,
                             [&](std::span<const Index> nodes, std::span<Vec3> u) {
                               backend_->read_displacement(nodes, u);
                             },
                             {}};
    view.corners = crack_.body.corners();
    view.pools = backend_->pools();
    const Crack shorter = ends_at(tip);
    return {crack_.board.plane().lift(shorter.tips[tip].position),
            meter_.at(shorter, tip, view).factors};
  }
  /// Half the work of the forces.
  [[nodiscard]] double energy() {
    solve();
    std::vector<double> u(force_.size());
    backend_->read_displacement(u);
    double work = 0;
    for (std::size_t i = 0; i < u.size(); ++i) work += force_[i] * u[i];
    return work / 2;
  }
  [[nodiscard]] Vec3 end(std::size_t tip) const {
    return crack_.board.plane().lift(ends_at(tip).tips[tip].position);
  }

 private:
  [[nodiscard]] Crack ends_at(std::size_t tip) const {
    return fracture::as_its_field_shows(crack_.crack, tip, crack_.board, problem_->material(0));
  }
  void solve() {
    backend_->set_load(load_of(*problem_, force_, grips_));
    backend_->solve();
  }

  std::shared_ptr<const Problem> problem_;
  std::unique_ptr<Backend> backend_;
  EdgeSplit crack_;
  fracture::FieldIntensityMeter meter_;
  std::vector<double> force_, grips_;
};

}  // namespace sunder::test
