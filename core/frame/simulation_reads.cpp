// SPDX-License-Identifier: Apache-2.0
// What is read of a simulation.
#include <algorithm>
#include <numeric>

#include "body/hyperelastic.hpp"
#include "body/law_stress.hpp"
#include "body/pieces.hpp"
#include "body/pools.hpp"
#include "fracture/criterion.hpp"
#include "fracture/finding.hpp"
#include "frame/loads.hpp"
#include "sunder/error.hpp"
#include "sunder/simulation.hpp"

namespace sunder {
namespace {

/// Of the elements that are not out, by laws of finite deformation.
Vec3 forces_of_supports(const Problem& problem, std::span<const std::uint8_t> out,
                        std::span<const double> u) {
  std::vector<double> forces(u.size());
  const std::vector<const Law*> laws = fem::laws_of(problem);
  LooseSearch search(problem);
  search.look(out);
  const auto split = problem.pools()->split([&](Index e) { return search.body_of(e); });
  fem::internal_forces({problem, laws, out, split}, u, forces);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (problem.dofs()[i] == kNone) sum[static_cast<Eigen::Index>(i % 3)] += forces[i];
  }
  return sum;
}

}  // namespace

const std::vector<Crack>& Simulation::cracks() const { return criterion_->cracks(); }

Mesh Simulation::mesh() const {
  Mesh mesh = problem_->mesh();
  const auto corners = criterion_->corners();
  if (corners.empty()) return mesh;
  mesh.nodes.resize(static_cast<std::size_t>(backend_->node_count()), Vec3::Zero());
  for (std::size_t e = 0; e < corners.size(); ++e) {
    for (std::size_t a = 0; a < 4; ++a) {
      mesh.nodes[static_cast<std::size_t>(corners[e][a])] =
          problem_->mesh().nodes[static_cast<std::size_t>(problem_->mesh().tets[e][a])];
    }
    mesh.tets[e] = corners[e];
  }
  return mesh;
}

std::span<const std::array<Index, 4>> Simulation::corners() const { return criterion_->corners(); }

Index Simulation::piece_of(Index element) const {
  return looks_ == 0 || backend_->destroyed()[element] ? kNone : loose_->piece_of(element);
}

std::vector<CrackFace> Simulation::crack_faces() const { return criterion_->faces(); }

std::vector<TipState> Simulation::tips() {
  std::vector<TipState> tips;
  if (!now_.solved) return tips;
  std::vector<Finding> found;
  criterion_->tips(fracture_state({}), tips, found);
  for (const Finding& finding : found) note(finding);
  return tips;
}

std::vector<Vec3> Simulation::reactions() const {
  Reactions r;
  read(r);
  return r.forces;
}

void Simulation::read(Reactions& r) const {
  r.forces.clear();
  for (std::size_t i = 0; i < problem_->scene().instruments.size(); ++i) {
    r.forces.push_back(loads_->force(i));
  }
  r.grips.assign(backend_->gripped_dofs().size(), 0.0);
  if (r.grips.empty() || (!now_.solved && (now_.warm || loads_->gripped().empty()))) return;
  backend_->read_reactions(r.grips);
  for (std::size_t g = 0; g < loads_->gripped().size(); ++g) {
    r.grips[g] -= loads_->weight_on_grip(g);
    const auto& of = loads_->gripped()[g];
    r.forces[of.instrument][of.axis] += r.grips[g];
  }
}

Vec3 Simulation::support_reaction() const {
  const std::vector<Vec3> displacement = this->displacement();
  std::vector<double> u(3 * problem_->mesh().nodes.size());  // of the element in work
  const auto destroyed = backend_->destroyed();
  const auto split = criterion_->corners();
  Vec3 sum = -loads_->force_on_supports();
  if (problem_->moves()) sum += backend_->held_beside();
  if (problem_->pools()) return sum + pooled_reaction(displacement);
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    const auto& tet = problem_->mesh().tets[e];
    const auto& corners = split.empty() ? tet : split[static_cast<std::size_t>(e)];
    const auto held = [&](int a, int axis) { return problem_->dof(tet[a], axis) == kNone; };
    Eigen::Matrix<double, 3, 4> forces;
    bool known = false;
    for (int a = 0; a < 4; ++a) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!held(a, axis)) continue;
        if (!known) {
          for (std::size_t c = 0; c < 4; ++c) {
            std::copy_n(displacement[static_cast<std::size_t>(corners[c])].data(), 3,
                        u.data() + 3 * static_cast<std::size_t>(tet[c]));
          }
          forces = fem::corner_forces(*problem_, e, u, destroyed[e] != 0);
        }
        known = true;
        sum[axis] += forces(axis, a);
      }
    }
  }
  return sum;
}

/// The body as cracks have split it; null: as the mesh has it.
std::shared_ptr<const Problem> Simulation::parted_now() const {
  const auto corners = criterion_->corners();
  if (corners.empty()) return nullptr;
  std::vector<NodeThatParts> nodes(
      static_cast<std::size_t>(backend_->node_count() - problem_->node_count()));
  for (std::size_t e = 0; e < corners.size(); ++e) {
    for (std::size_t a = 0; a < 4; ++a) {
      const Index added = corners[e][a] - problem_->node_count(),
                  parent = problem_->mesh().tets[e][a];
      if (added < 0) continue;
      NodeThatParts& node = nodes[static_cast<std::size_t>(added)];
      node = {parent, Axes{0}};
      for (int axis = 0; axis < 3; ++axis) {
        const bool free = problem_->dof(parent, axis) != kNone;
        node.axes.bits = static_cast<std::uint8_t>(node.axes.bits | (free ? 1U << axis : 0U));
      }
    }
  }
  return std::make_shared<const Problem>(
      *problem_, std::vector<std::array<Index, 4>>(corners.begin(), corners.end()), nodes);
}

/// The same where patches have a pressure of all their elements' displacement.
Vec3 Simulation::pooled_reaction(std::span<const Vec3> displacement) const {
  std::vector<double> u;
  u.reserve(3 * displacement.size());
  for (const Vec3& x : displacement) u.insert(u.end(), x.data(), x.data() + 3);
  const auto parted = parted_now();
  const Problem& body = parted ? *parted : *problem_;
  // By a law of its own each element counts whole or not at all, and a piece that is cut off shares
  // no patch with the rest.
  if (problem_->finite() || problem_->moves() || problem_->fibrous()) {
    std::vector<std::uint8_t> out(backend_->destroyed().begin(), backend_->destroyed().end());
    for (std::size_t e = 0; e < now_.cut_off.size(); ++e) out[e] |= now_.cut_off[e];
    return forces_of_supports(body, out, u);
  }
  std::vector<double> scale;
  scale.reserve(problem_->mesh().tets.size());
  for (std::uint8_t gone : backend_->destroyed()) {
    scale.push_back(gone ? problem_->scene().fracture.alpha : 1.0);
  }
  const fem::StressField field(body, scale, u, backend_->pools());
  Vec3 sum = Vec3::Zero();
  for (Index e = 0; e < body.tet_count(); ++e) {
    const auto& tet = body.mesh().tets[static_cast<std::size_t>(e)];
    const auto held = [&](Index n, int axis) { return body.dof(n, axis) == kNone; };
    const auto at_support = [&](Index n) { return held(n, 0) || held(n, 1) || held(n, 2); };
    if (std::ranges::none_of(tet, at_support)) continue;
    const auto forces = fem::corner_forces(body, e, field, scale[static_cast<std::size_t>(e)]);
    for (std::size_t a = 0; a < 4; ++a) {
      for (int axis = 0; axis < 3; ++axis) {
        if (held(tet[a], axis)) sum[axis] += forces(axis, static_cast<Eigen::Index>(a));
      }
    }
  }
  return sum;
}

std::vector<Index> Simulation::acting_nodes(std::size_t instrument) const {
  const auto nodes = loads_->nodes(instrument);
  return {nodes.begin(), nodes.end()};
}

/// Of a rigid grip: what its forces do beyond their resultant.
double Simulation::work_of_turn(std::size_t instrument, const Vec3& displacement) const {
  double work = 0;
  for (std::size_t g = 0; g < loads_->gripped().size(); ++g) {
    const auto& of = loads_->gripped()[g];
    if (of.instrument != instrument) continue;
    work += reactions_.grips[g] * (loads_->load().displacements[g] - displacement[of.axis]);
  }
  return work;
}

double Simulation::compliance() {
  read(reactions_);
  const std::vector<Vec3>& forces = reactions_.forces;
  std::vector<Vec3>& u = reactions_.displacement;
  double work = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    if (problem_->scene().instruments.empty()) break;
    const auto* grip = std::get_if<Grip>(&problem_->scene().instruments[i].action);
    if (grip) {
      const Vec3 displacement = loads_->value(i, now_.scene_time);
      for (int axis = 0; axis < 3; ++axis) {
        if (grip->axes.has(axis)) work += forces[i][axis] * displacement[axis];
      }
      if (grip->rigid) work += work_of_turn(i, displacement);
      continue;
    }
    const auto nodes = loads_->nodes(i);
    if (nodes.empty()) continue;
    u.resize(nodes.size());
    backend_->read_displacement(nodes, u);
    Vec3 mean = Vec3::Zero();
    for (const Vec3& v : u) mean += v;
    work += forces[i].dot(mean) / static_cast<double>(nodes.size());
  }
  return work + work_of_tools();
}

/// Of what a host holds and pushes the body by; of reactions_, which are read.
double Simulation::work_of_tools() {
  double work = 0;
  for (const Tool& tool : loads_->tools()) {
    if (!tool.holds) {
      std::vector<Vec3>& u = reactions_.displacement;
      u.resize(tool.nodes.size());
      backend_->read_displacement(tool.nodes, u);
      for (const Vec3& at : u) work += tool.force.dot(at) / static_cast<double>(u.size());
      continue;
    }
    for (std::size_t g = tool.first; g < tool.first + 3 * tool.nodes.size(); ++g) {
      work += reactions_.grips[g] * loads_->load().displacements[g];
    }
  }
  return work;
}

std::vector<Vec3> Simulation::velocity() const {
  std::vector<Vec3> result(problem_->mesh().nodes.size());
  backend_->read_velocity({result.front().data(), 3 * result.size()});
  return result;
}

std::vector<Vec3> Simulation::displacement() const {
  std::vector<Vec3> result(static_cast<std::size_t>(backend_->node_count()), Vec3::Zero());
  if (!now_.solved) return result;
  if (backend_->node_count() > problem_->node_count()) {
    std::vector<Index> nodes(result.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    backend_->read_displacement(nodes, result);
    return result;
  }
  std::vector<double> flat(3 * result.size());
  backend_->read_displacement(flat);
  for (std::size_t n = 0; n < result.size(); ++n) {
    result[n] = Vec3(flat[3 * n], flat[3 * n + 1], flat[3 * n + 2]);
  }
  return result;
}

std::vector<Voigt> Simulation::stress() const {
  std::vector<Voigt> result(problem_->mesh().tets.size(), Voigt::Zero());
  if (!backend_->needs().stress) throw UsageError("stress was left out of this simulation");
  if (now_.solved) backend_->read_stress(result);
  return result;
}

}  // namespace sunder
