// SPDX-License-Identifier: Apache-2.0
#include "verification/pooled_cases.hpp"

#include <cmath>
#include <numbers>

#include "material/linear.hpp"
#include "sunder/stress_measures.hpp"
#include "support/body.hpp"
#include "support/structured_board.hpp"
#include "support/traction.hpp"

namespace sunder::test {
namespace {

constexpr double kInner = 10, kOuter = 20, kPressure = 1e-3, kNear = 1e-6;

Scene scene_of(Mesh mesh, const Material& material) {
  Scene scene;
  scene.mesh = std::move(mesh);
  scene.materials["board"] = material;
  scene.solver.route = Route::factor;
  return scene;
}

Material nearly_incompressible(double young, double poisson, MaterialVolume volume) {
  Material material{young, poisson, 1.0};
  material.volume = volume;
  return material;
}

double radius(const Vec3& x) { return std::hypot(x.x(), x.y()); }
bool on_inner(const Vec3& x) { return radius(x) < kInner + kNear; }

Scene cylinder(MaterialVolume volume, double poisson, Index cells) {
  const double length = (kOuter - kInner) / cells;
  Mesh mesh = structured_board({cells, 2 * cells, 1, 1, 1, length});
  for (Vec3& x : mesh.nodes) {
    const double r = kInner + (kOuter - kInner) * x.x(), angle = std::numbers::pi / 2 * x.y();
    x.head<2>() << r * std::cos(angle), r * std::sin(angle);
    if (x.x() < kNear) x.x() = 0;
  }
  Scene scene = scene_of(std::move(mesh), nearly_incompressible(1, poisson, volume));
  const Vec3 low(-1, -1, -1), high(kOuter + 1, kOuter + 1, length + 1);
  scene.supports.push_back({Box{low, Vec3(kNear, high.y(), high.z())}, Axes{1}});
  scene.supports.push_back({Box{low, Vec3(high.x(), kNear, high.z())}, Axes{2}});
  scene.supports.push_back({Box{low, high}, Axes{4}});  // plane strain
  return scene;
}

/// Lame: u_r [mm] and the difference of hoop and radial stress [MPa].
double radial_displacement(double poisson, double r) {
  const double ratio = kInner * kInner / (kOuter * kOuter - kInner * kInner);
  return (1 + poisson) * kPressure * ratio * ((1 - 2 * poisson) * r + kOuter * kOuter / r);
}
double hoop_over_radial(double r) {
  const double ratio = kInner * kInner / (kOuter * kOuter - kInner * kInner);
  return 2 * kPressure * ratio * kOuter * kOuter / (r * r);
}

}  // namespace

LameErrors lame_errors(MaterialVolume volume, double poisson, Index cells) {
  const Body body(cylinder(volume, poisson, cells));
  const Mesh& mesh = body.problem->mesh();
  body.load(
      traction_force(mesh, on_inner, [](const Vec3& normal) { return Vec3(-kPressure * normal); }));
  body.backend->solve();
  const std::vector<double> u = body.displacement();
  LameErrors errors;
  int count = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (!on_inner(mesh.nodes[n])) continue;
    errors.u += std::hypot(u[3 * n], u[3 * n + 1]);
    ++count;
  }
  errors.u = errors.u / count / radial_displacement(poisson, kInner) - 1;
  const std::vector<Voigt> stress = body.stress();
  double difference = 0, all = 0;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    Vec3 middle = Vec3::Zero();
    for (Index n : mesh.tets[static_cast<std::size_t>(e)]) {
      middle += mesh.nodes[static_cast<std::size_t>(n)] / 4;
    }
    const double right = hoop_over_radial(radius(middle)), weight = body.problem->shape(e).volume;
    const double tresca = yield_measure(stress[static_cast<std::size_t>(e)], YieldMeasure::tresca);
    difference += weight * (tresca - right) * (tresca - right);
    all += weight * right * right;
  }
  errors.tresca = std::sqrt(difference / all);
  return errors;
}

namespace {

/// In steps of the load: vertical displacement at (48, 60).
double cook(const Material& material, Index cells, int steps) {
  Mesh mesh = structured_board({cells, cells, 1, 48, 44, 1});
  for (Vec3& x : mesh.nodes) {
    const double xi = x.x() / 48, eta = x.y() / 44;
    x.y() = 44 * xi + (44 - 28 * xi) * eta;
  }
  Scene scene = scene_of(std::move(mesh), material);
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(kNear, 100, 2)}, Axes{3}});
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(100, 100, 2)}, Axes{4}});
  const Body body(std::move(scene));
  const Mesh& made = body.problem->mesh();
  for (int step = 1; step <= steps; ++step) {
    const double part = static_cast<double>(step) / steps;
    body.load(traction_force(
        made, [](const Vec3& x) { return x.x() > 48 - kNear; },
        [&](const Vec3&) { return Vec3(0, 6.25 * part, 0); }));
    body.backend->solve();
  }
  const std::vector<double> u = body.displacement();
  for (std::size_t n = 0; n < made.nodes.size(); ++n) {
    if ((made.nodes[n].head<2>() - Vec2(48, 60)).norm() < kNear) return u[3 * n + 1];
  }
  return 0;
}

}  // namespace

double incompressible_cook(MaterialVolume volume, Index cells) {
  return cook(nearly_incompressible(240.565, 0.4999, volume), cells, 1);
}

double neo_hookean_cook(MaterialVolume volume, Index cells, int steps) {
  Material material = nearly_incompressible(240.565, 0.4999, volume);
  material.law = MaterialLaw::neo_hookean;
  return cook(material, cells, steps);
}

namespace {

double block_force(const Material& material, Index n, double pressed) {
  Scene scene = scene_of(structured_board({n, n, n / 2, 10, 10, 5}), material);
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(11, 11, kNear)}, Axes{7}});
  Instrument plate;
  plate.action = Grip{Box{Vec3(-1, -1, 5 - kNear), Vec3(11, 11, 6)}, Vec3(0, 0, -pressed), Axes{7}};
  scene.instruments.push_back(plate);
  const Body body(std::move(scene));
  const auto gripped = body.problem->gripped_dofs();
  std::vector<double> displacement(gripped.size(), 0.0);
  std::vector<std::uint8_t> down(static_cast<std::size_t>(body.problem->dof_count()), 0);
  for (Index node = 0; node < body.problem->node_count(); ++node) {
    if (body.problem->dof(node, 2) != kNone) {
      down[static_cast<std::size_t>(body.problem->dof(node, 2))] = 1;
    }
  }
  for (std::size_t g = 0; g < gripped.size(); ++g) {
    if (down[static_cast<std::size_t>(gripped[g])]) displacement[g] = -pressed;
  }
  body.load(std::vector<double>(body.problem->dofs().size(), 0.0), displacement);
  body.backend->solve();
  const std::vector<double> reactions = body.reactions();
  double force = 0;
  for (std::size_t g = 0; g < gripped.size(); ++g) {
    if (down[static_cast<std::size_t>(gripped[g])]) force -= reactions[g];
  }
  return force;
}

}  // namespace

double bonded_block_force(MaterialVolume volume, Index n) {
  return block_force(nearly_incompressible(1, 0.4999, volume), n, 0.1);
}

double neo_hookean_block_force(Index n) {
  Material material = nearly_incompressible(1, 0.4999, MaterialVolume::pooled);
  material.law = MaterialLaw::neo_hookean;
  return 1000 * block_force(material, n, 1e-4);
}

}  // namespace sunder::test
