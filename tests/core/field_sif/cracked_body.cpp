// SPDX-License-Identifier: Apache-2.0
#include "core/field_sif/cracked_body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "body/assembly.hpp"
#include "fracture/band.hpp"
#include "fracture/crack_path.hpp"
#include "linear_algebra/factor.hpp"

namespace sunder::test {
namespace {}  // namespace

CrackedBody::CrackedBody(Scene scene) : problem_(std::make_unique<Problem>(std::move(scene))) {
  destroyed_.assign(problem_->mesh().tets.size(), 0);
  force_.assign(3 * problem_->mesh().nodes.size(), 0);
  board_ = std::make_unique<fracture::Board>(problem_->mesh(), Vec3(0, 0, 1));
  meter_ = std::make_unique<fracture::FieldIntensityMeter>(*problem_, *board_);
}

void CrackedBody::set_crack(CrackKind kind, const Vec2& from, const Vec2& to,
                            const std::vector<Index>& elements) {
  const Vec2 start = in_plane(from), end = in_plane(to), d = (end - start).normalized();
  crack_ = {};
  crack_.kind = kind;
  crack_.path = {start, end};
  crack_.length = (end - start).norm();
  crack_.elements.assign(elements.begin(), elements.end());
  if (kind == CrackKind::edge) {
    crack_.mouth = start;
    crack_.tips = {{end, d, false}};
  } else {
    crack_.tips = {{start, -d, false}, {end, d, false}};
  }
  for (Index e : elements) destroyed_[e] = 1;
}

void CrackedBody::find_fine_part() {
  if (fine_) return;
  const Mesh& mesh = problem_->mesh();
  std::vector<double> size;  // longest edge
  for (const auto& tet : mesh.tets) {
    size.push_back(0);
    for (Index a : tet)
      for (Index b : tet)
        size.back() = std::max(size.back(), (mesh.nodes[a] - mesh.nodes[b]).norm());
  }
  std::vector<double> sorted = size;
  const auto tenth = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 10);
  std::nth_element(sorted.begin(), tenth, sorted.end());
  const double fine = 1.6 * *tenth;
  fine_mesh_ = std::make_unique<Mesh>();
  fine_mesh_->nodes = mesh.nodes;
  fine_mesh_->volumes = mesh.volumes;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    if (size[static_cast<std::size_t>(e)] > fine) continue;
    fine_elements_.push_back(e);
    fine_mesh_->tets.push_back(mesh.tets[e]);
    fine_mesh_->volume_of.push_back(0);
  }
  fine_ = std::make_unique<fracture::Board>(*fine_mesh_, Vec3(0, 0, 1));
}

void CrackedBody::grow(std::size_t tip, const Vec2& direction, double length) {
  const Vec2 g = in_plane(direction).normalized();
  find_fine_part();
  const double h = fine_->h();
  std::vector<std::uint8_t> fine_destroyed;
  for (Index e : fine_elements_) fine_destroyed.push_back(destroyed_[e]);
  const std::vector<double> yields(fine_elements_.size(), 1.0);
  const fracture::ElementView view{fine_destroyed, yields};
  fracture::BandSearch bands(*fine_);
  fracture::Walk walk;
  const int sense = fracture::orientation(crack_, tip);
  for (double left = length; left > h / 2;) {
    const fracture::Ray ray{crack_.tips[tip].position, g, &crack_, sense};
    const fracture::Band& band = bands.find(ray, view);
    // The K whose reach is what is left (Eq. 1 at theta = 0, yield 1).
    const double k = std::sqrt(2 * std::numbers::pi * left);
    fracture::walk_band(band, h, k, 0, view, walk);
    if (!(walk.advance > 0)) throw std::runtime_error("the crack finds nothing ahead of it");
    std::map<Index, std::int8_t> labels;
    for (const fracture::Passed& passed : walk.passed) {
      destroyed_[fine_elements_[passed.element]] = fine_destroyed[passed.element] = 1;
      crack_.elements.push_back(fine_elements_[passed.element]);
      for (Index n : fine_mesh_->tets[passed.element])
        if (const int side = fracture::node_side(*fine_, ray, band.near_side, n))
          labels[n] = static_cast<std::int8_t>(side * sense);
    }
    for (const auto& [node, side] : labels) crack_.side[node] = side;
    fracture::advance_tip(crack_, tip, g, walk.advance);
    left -= walk.advance;
  }
}

void CrackedBody::add_force(Index node, const Vec3& force) {
  for (int axis = 0; axis < 3; ++axis) force_[3 * node + axis] += force[axis];
}

void CrackedBody::load_uniform(double s_xx, double s_yy, double s_xy) {
  Mat3 stress = Mat3::Zero();
  stress(0, 0) = s_xx;
  stress(1, 1) = s_yy;
  stress(0, 1) = stress(1, 0) = s_xy;
  const auto& x = problem_->mesh().nodes;
  Vec3 lo = x.front(), hi = x.front();
  for (const Vec3& p : x) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  for (const FreeFace& face : free_faces(problem_->mesh())) {
    const auto& [a, b, c] = face.nodes;
    const Vec3 area = (x[b] - x[a]).cross(x[c] - x[a]) / 2;
    const Vec3 middle = (x[a] + x[b] + x[c]) / 3;
    const bool outer =
        std::min((middle - lo).head<2>().minCoeff(), (hi - middle).head<2>().minCoeff()) < kClose;
    if (!outer) continue;  // top, bottom and the faces of split nodes
    for (Index n : face.nodes) add_force(n, stress * area / 3);
  }
}

void CrackedBody::solve() {
  const linear_algebra::Factor factor(fem::assemble_lower(*problem_, scale()));
  Eigen::VectorXd f(problem_->dof_count());
  fem::gather(*problem_, force_, {f.data(), static_cast<std::size_t>(f.size())});
  const Eigen::VectorXd u = factor.solve(f);
  displacement_.assign(force_.size(), 0);
  fem::scatter(*problem_, {u.data(), static_cast<std::size_t>(u.size())}, displacement_);
}

std::vector<double> CrackedBody::scale() const {
  std::vector<double> scale(destroyed_.size(), 1.0);
  for (std::size_t e = 0; e < scale.size(); ++e)
    if (destroyed_[e]) scale[e] = problem_->scene().fracture.alpha;
  return scale;
}

double CrackedBody::energy() const {
  double work = 0;
  for (std::size_t i = 0; i < force_.size(); ++i) work += force_[i] * displacement_[i];
  return work / 2;
}

fracture::FieldView CrackedBody::view() const {
  return {destroyed_,
          [this](std::span<const Index> nodes, std::span<Vec3> u) {
            for (std::size_t i = 0; i < nodes.size(); ++i)
              u[i] = Eigen::Map<const Vec3>(displacement_.data() + 3 * nodes[i]);
          },
          crack_forces_};
}

fracture::FieldIntensity CrackedBody::intensity(double radius, int tip) {
  const std::size_t last = crack_.tips.size() - 1;
  return meter_->at(crack_, last - static_cast<std::size_t>(tip), view(), radius);
}

fracture::FieldIntensity CrackedBody::chosen_intensity(std::size_t tip) {
  return meter_->at(crack_, tip, view());
}

std::vector<fracture::FieldIntensity> CrackedBody::front(int stations) {
  return meter_->along_front(crack_, crack_.tips.size() - 1, view(), stations);
}

}  // namespace sunder::test
