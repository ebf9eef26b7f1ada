// SPDX-License-Identifier: Apache-2.0
#include "verification/engine_cases.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <stdexcept>

#include "support/accuracy.hpp"
#include "support/sequences.hpp"
#include "support/structured_board.hpp"
#include "support/table1_board.hpp"
#include "support/traction.hpp"
#include "verification/calculix.hpp"

namespace sunder::test {
namespace {

constexpr double kYoung = 5, kPoisson = 0.4;
const Vec3 kSize(4, 4, 2);

bool on_surface(const Vec3& x) {
  return (x.array() < 1e-9).any() || (x.array() > kSize.array() - 1e-9).any();
}

/// Inner nodes moved by up to a quarter cell; surface nodes slide in their face or edge.
Mesh distorted_patch() {
  Mesh mesh = structured_board({4, 4, 2, kSize.x(), kSize.y(), kSize.z()});
  std::mt19937 generator(5);
  for (Vec3& x : mesh.nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      const double shift = 0.5 * (static_cast<double>(generator()) / 4294967296.0 - 0.5);
      if (x[axis] > 1e-9 && x[axis] < kSize[axis] - 1e-9) x[axis] += shift;
    }
  }
  return mesh;
}

Scene patch_scene() {
  Scene scene;
  scene.mesh = distorted_patch();
  scene.materials["board"] = {kYoung, kPoisson, 1.0};
  return scene;
}

/// D strain with the Lame constants of E 5, nu 0.4.
Voigt stress_of(const Mat3& gradient) {
  const double mu = kYoung / (2 * (1 + kPoisson));
  const double lambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));
  const Mat3 s =
      lambda * gradient.trace() * Mat3::Identity() + mu * (gradient + gradient.transpose());
  Voigt v;
  v << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0);
  return v;
}

std::vector<double> field(const Mesh& mesh, const Mat3& gradient) {
  std::vector<double> u;
  for (const Vec3& x : mesh.nodes) {
    const Vec3 v = gradient * x;
    u.insert(u.end(), {v.x(), v.y(), v.z()});
  }
  return u;
}

Mat3 unit_strain(int component) {
  Mat3 h = Mat3::Zero();
  const int row[] = {0, 1, 2, 0, 1, 2}, column[] = {0, 1, 2, 1, 2, 0};
  h(row[component], column[component]) = 0.01;
  return h;
}

Scene held_patch(PatchHeld held) {
  Scene scene = patch_scene();
  if (held == PatchHeld::surface) {
    std::vector<Index> surface;
    for (Index n = 0; n < scene.mesh.node_count(); ++n)
      if (on_surface(scene.mesh.nodes[n])) surface.push_back(n);
    Instrument grip;
    grip.action = Grip{surface, Vec3::Zero(), Axes{7}};
    scene.instruments.push_back(grip);
  } else {
    // Three-two-one: the support's forces must come out as zero.
    scene.supports.push_back({std::vector<Index>{0}, Axes{7}});
    scene.supports.push_back({std::vector<Index>{4}, Axes{6}});   // along x: holds y and z
    scene.supports.push_back({std::vector<Index>{20}, Axes{4}});  // along y: holds z
  }
  return scene;
}

/// Prescribed displacements, or the surface's traction.
void load_patch(const Body& body, const Mat3& gradient, PatchHeld held) {
  const auto u = field(body.problem->mesh(), gradient);
  if (held == PatchHeld::surface) {
    std::vector<double> prescribed;
    const auto gripped = body.problem->gripped_dofs();
    for (std::size_t i = 0; i < u.size(); ++i)
      if (std::binary_search(gripped.begin(), gripped.end(), body.problem->dofs()[i]))
        prescribed.push_back(u[i]);
    body.load(std::vector<double>(u.size(), 0.0), prescribed);
    return;
  }
  const Voigt s = stress_of(gradient);
  Mat3 stress;
  stress << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  body.load(traction_force(body.problem->mesh(), on_surface,
                           [&](const Vec3& normal) { return Vec3(stress * normal); }));
}

Scene cantilever(Index cells) {
  Scene scene;
  scene.mesh = structured_board({10 * cells, cells, cells, 10, 1, 1});
  scene.materials["board"] = {5, 0, std::nullopt};
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-9, 2, 2)}, Axes{7}});
  return scene;
}

Mesh membrane(Index cells) {
  Mesh mesh = structured_board({cells, cells, 1, 48, 44, 1});
  for (Vec3& x : mesh.nodes) {
    const double xi = x.x() / 48, eta = x.y() / 44;
    x.y() = 44 * xi + (44 - 28 * xi) * eta;  // from (0, 44) at the left to (44, 60) at the right
  }
  return mesh;
}

void hold_membrane(Scene& scene, Plane plane) {
  const auto column = [](double x, double low, double high) {
    return Box{Vec3(x - 1e-6, low - 1e-6, -1), Vec3(x + 1e-6, high + 1e-6, 1e-6)};
  };
  scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(1e-6, 100, 2)}, Axes{3}});
  if (plane == Plane::strain) {
    scene.supports.push_back({Box{Vec3(-1, -1, -1), Vec3(100, 100, 2)}, Axes{4}});
    return;
  }
  // Free to change its thickness: z is held at three nodes only.
  scene.supports.push_back({column(0, 0, 0), Axes{4}});
  scene.supports.push_back({column(0, 44, 44), Axes{4}});
  scene.supports.push_back({column(48, 60, 60), Axes{4}});
}

Scene cook(Plane plane, Index cells) {
  Scene scene;
  scene.mesh = membrane(cells);
  scene.materials["board"] = {plane == Plane::strain ? 70.0 : 1.0, 1.0 / 3, std::nullopt};
  hold_membrane(scene, plane);
  return scene;
}

using Where = std::function<bool(const Vec3&)>;

double mean_at(const Mesh& mesh, const std::vector<double>& u, int axis, const Where& where) {
  double sum = 0;
  int count = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (!where(mesh.nodes[n])) continue;
    sum += u[3 * n + static_cast<std::size_t>(axis)];
    ++count;
  }
  if (count == 0) throw std::runtime_error("no node where the displacement is asked for");
  return sum / count;
}

CalculixResult by_calculix(const Problem& problem, std::span<const double> scale,
                           const std::vector<double>& force) {
  const auto folder =
      std::filesystem::temp_directory_path() / ("sunder-ccx-" + std::to_string(getpid()));
  return run_calculix(problem, scale, force, folder);
}

/// One displacement by both, of one problem.
Twin twin(const Body& body, const std::vector<double>& force, int axis, const Where& where) {
  const Mesh& mesh = body.problem->mesh();
  body.load(force);
  body.backend->solve();
  const auto other = by_calculix(*body.problem, body.scale(), force);
  return {mean_at(mesh, body.displacement(), axis, where),
          mean_at(mesh, other.displacement, axis, where)};
}

bool at_end(const Vec3& x) { return x.x() > 10 - 1e-9; }
bool at_right(const Vec3& x) { return x.x() > 48 - 1e-6; }

std::vector<double> end_load(const Mesh& mesh, int axis) {
  return traction_force(mesh, at_end, [&](const Vec3&) { return Vec3(1e-3 * Vec3::Unit(axis)); });
}

std::vector<double> cook_load(const Mesh& mesh, Plane plane) {
  const double shear = plane == Plane::strain ? 6.25 : 1.0 / 16;
  return traction_force(mesh, at_right, [&](const Vec3&) { return Vec3(0, shear, 0); });
}

Where cook_point(Plane plane) {
  const double y = plane == Plane::strain ? 60 : 52;
  return [y](const Vec3& x) { return at_right(x) && std::abs(x.y() - y) < 1e-6; };
}

}  // namespace

PatchErrors patch_errors(int component, PatchHeld held) {
  Mat3 gradient = unit_strain(component);
  // u_x = z instead of u_z = x: 0 at the dofs that three nodes hold.
  if (held == PatchHeld::three_nodes && component == 5) gradient.transposeInPlace();
  const Body body(held_patch(held));
  const Mesh& mesh = body.problem->mesh();
  load_patch(body, gradient, held);
  PatchErrors errors;
  errors.residual = body.backend->solve().residual;
  const std::vector<std::uint8_t> none(mesh.tets.size(), 0);
  const std::vector<Voigt> expected(mesh.tets.size(), stress_of(gradient));
  errors.u = displacement_error(mesh, none, body.displacement(), field(mesh, gradient));
  errors.stress = stress_error(none, body.stress(), expected);
  return errors;
}

double mean_end_deflection(Index cells, int axis) {
  const Body body(cantilever(cells), Needs{});
  body.load(end_load(body.problem->mesh(), axis));
  body.backend->solve();
  return mean_at(body.problem->mesh(), body.displacement(), axis, at_end);
}

double cook_deflection(Plane plane, Index cells) {
  const Body body(cook(plane, cells), Needs{});
  body.load(cook_load(body.problem->mesh(), plane));
  body.backend->solve();
  return mean_at(body.problem->mesh(), body.displacement(), 1, cook_point(plane));
}

Twin cantilever_twin(Index cells) {
  const Body body(cantilever(cells), Needs{});
  return twin(body, end_load(body.problem->mesh(), 1), 1, at_end);
}

Twin cook_twin(Plane plane, Index cells) {
  const Body body(cook(plane, cells), Needs{});
  return twin(body, cook_load(body.problem->mesh(), plane), 1, cook_point(plane));
}

TwinErrors board_twin(std::size_t fractures, Route route) {
  Scene scene = held_board();
  scene.solver.route = route;
  const Body body(std::move(scene));
  const Mesh& mesh = body.problem->mesh();
  std::vector<double> force(3 * mesh.nodes.size(), 0.0);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vec3& x = mesh.nodes[n];
    if (x.x() > 49.999 && x.y() < 0.001) force[3 * n + 1] = -30;  // two nodes: 60 N
  }
  const auto torn = crack_sequence(*body.problem, fractures, 12);
  if (!torn.empty()) body.backend->destroy(torn);
  body.load(force);
  body.backend->solve();
  const CalculixResult other = by_calculix(*body.problem, body.scale(), force);
  const auto destroyed = body.backend->destroyed();
  return {displacement_error(mesh, destroyed, body.displacement(), other.displacement),
          stress_error(destroyed, body.stress(), other.stress)};
}

}  // namespace sunder::test
