// SPDX-License-Identifier: Apache-2.0
#include "sunder/interfaces.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "body/lay_interfaces.hpp"
#include "body/layer_geometry.hpp"
#include "sunder/error.hpp"
#include "sunder/stress_measures.hpp"

namespace sunder {
namespace {

/// Stretch of a principal Biot stress t of the layers' law: t = mu (s - 1/s).
double stretch(double t, double mu) {
  const double half = t / (2 * mu);
  return half < 0 ? 1 / (std::hypot(half, 1.0) - half) : std::hypot(half, 1.0) + half;
}

/// T = mu t(a) and W = mu w(a) at the normal strain a of the layers' law.
double traction_at(double a) { return 1 + a - 1 / (1 + a); }
double energy_at(double a) { return a + a * a / 2 - std::log1p(a); }

}  // namespace

namespace fem {

std::string interface_volume(std::size_t interface) {
  return "interface-" + std::to_string(interface);
}

LayerLaw layer_law(double strength, double energy, double thickness) {
  // w(a)/t(a) grows from a/2 at both ends and is never more than a.
  const double wanted = energy / (strength * thickness);
  double low = wanted, high = 2 * wanted + 1;
  for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
    const double a = (low + high) / 2;
    (energy_at(a) < wanted * traction_at(a) ? low : high) = a;
  }
  const double a = (low + high) / 2;
  return {strength / traction_at(a), a * thickness};
}

}  // namespace fem

Interfaces::Interfaces(const Scene& scene, std::span<const TetShape> shapes) {
  const Mesh& mesh = scene.mesh;
  std::vector<std::size_t> layer_of(mesh.volumes.size(), scene.interfaces.size());
  for (std::size_t i = 0; i < scene.interfaces.size(); ++i) {
    const Interface& interface = scene.interfaces[i];
    const auto volume =
        std::ranges::find(mesh.volumes, fem::interface_volume(i), &NamedVolume::name);
    layer_of[static_cast<std::size_t>(volume - mesh.volumes.begin())] = i;
    InterfaceLayer layer;
    layer.volume = static_cast<Index>(volume - mesh.volumes.begin());
    layer.mu = scene.materials.at(volume->name).young / 2;
    layer.strength = interface.strength;
    layer.energy = interface.energy;
    layer.shear_ratio = interface.shear_ratio;
    layers_.push_back(layer);
  }
  const auto of = [&](Index e) {
    return layer_of[static_cast<std::size_t>(mesh.volume_of[static_cast<std::size_t>(e)])];
  };
  while (first_ < mesh.tet_count() && of(first_) == layers_.size()) ++first_;
  std::vector<std::vector<std::uint8_t>> first_side;
  for (const Interface& interface : scene.interfaces) {
    first_side.push_back(fem::nodes_of_volume(mesh, interface.between[0]));
  }
  // Of each layer its own, as two may meet between the same two nodes.
  std::map<std::pair<std::size_t, std::array<Index, 2>>, std::vector<Index>> pairs;
  for (Index e = first_; e < mesh.tet_count(); ++e) {
    Element& element = elements_.emplace_back();
    if (of(e) == layers_.size()) continue;
    element.layer = of(e);
    const TetShape& shape = shapes[static_cast<std::size_t>(e)];
    const auto& tet = mesh.tets[static_cast<std::size_t>(e)];
    const Vec3 across = fem::slope_across(shape, tet, first_side[element.layer]);
    element.normal = across.normalized();
    element.area = shape.volume * across.norm();
    element.thickness = 1 / across.norm();
    if (!(element.area > 0)) {
      throw InputError(InputFault::degenerate_element,
                       "element " + std::to_string(e) + " of the layer " +
                           in_quotes(fem::interface_volume(element.layer)) +
                           " has no two sides: tissue of both hangs together beside it by an edge "
                           "or a node; part it in the mesh");
    }
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        const auto& x = mesh.nodes;
        const double length =
            (x[static_cast<std::size_t>(tet[i])] - x[static_cast<std::size_t>(tet[j])]).norm();
        if (length >= shortest) continue;
        shortest = length;
        element.nodes = {std::min(tet[i], tet[j]), std::max(tet[i], tet[j])};
      }
    }
    InterfaceLayer& layer = layers_[element.layer];
    layer.area += element.area;
    layer.thickness += shape.volume;
    pairs[{element.layer, element.nodes}].push_back(e);
  }
  for (InterfaceLayer& layer : layers_) {
    layer.thickness /= layer.area;
    layer.opening = fem::layer_law(layer.strength, layer.energy, layer.thickness).opening;
  }
  pair_begin_.push_back(0);
  for (const auto& [key, elements] : pairs) {
    for (Index e : elements) {
      elements_[static_cast<std::size_t>(e - first_)].pair = pair_begin_.size() - 1;
      of_pair_.push_back(e);
    }
    pair_begin_.push_back(of_pair_.size());
  }
  find_neighbours(mesh);
}

void Interfaces::find_neighbours(const Mesh& mesh) {
  std::map<Index, std::vector<std::size_t>> at_node;
  for (std::size_t p = 0; p < pair_count(); ++p) {
    for (Index n : nodes(elements(p).front())) at_node[n].push_back(p);
  }
  neighbour_begin_.push_back(0);
  for (std::size_t p = 0; p < pair_count(); ++p) {
    std::set<std::size_t> beside;
    for (Index e : elements(p)) {
      for (Index n : mesh.tets[static_cast<std::size_t>(e)]) {
        const auto found = at_node.find(n);
        if (found != at_node.end()) beside.insert(found->second.begin(), found->second.end());
      }
    }
    beside.erase(p);
    neighbours_.insert(neighbours_.end(), beside.begin(), beside.end());
    neighbour_begin_.push_back(neighbours_.size());
  }
}

/// F = R U and P = R T: the deformed normal is that of F^-T N = R U^-1 N, the traction R T N.
Traction Interfaces::traction(Index element, const Voigt& biot) const {
  const Mat3 t = tensor(biot);
  if (!t.allFinite()) return {};
  const Eigen::SelfAdjointEigenSolver<Mat3> of(t);
  const Vec3& normal = at(element).normal;
  const double mu = layer(element).mu;
  Vec3 turned = Vec3::Zero(), force = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = of.eigenvectors().col(i);
    const double part = axis.dot(normal);
    turned += part / stretch(of.eigenvalues()[i], mu) * axis;
    force += part * of.eigenvalues()[i] * axis;
  }
  const double along = force.dot(turned.normalized());
  return {along, std::sqrt(std::max(force.squaredNorm() - along * along, 0.0))};
}

double Interfaces::ratio(Index element, const Voigt& biot) const {
  const Traction of = traction(element, biot);
  const InterfaceLayer& l = layer(element);
  return std::hypot(std::max(of.normal, 0.0), of.shear / l.shear_ratio) / l.strength;
}

double Interfaces::energy(Index element, const Voigt& biot) const {
  const Mat3 t = tensor(biot);
  if (!t.allFinite()) return 0;
  const Eigen::SelfAdjointEigenSolver<Mat3> of(t, Eigen::EigenvaluesOnly);
  const InterfaceLayer& l = layer(element);
  double w = 0;
  for (int i = 0; i < 3; ++i) w += energy_at(stretch(of.eigenvalues()[i], l.mu) - 1);
  return l.mu * w * at(element).thickness * area(element);
}

std::shared_ptr<const Interfaces> interfaces_of(const Scene& scene,
                                                std::span<const TetShape> shapes) {
  return scene.interfaces.empty() ? nullptr : std::make_shared<const Interfaces>(scene, shapes);
}

}  // namespace sunder
