// SPDX-License-Identifier: Apache-2.0
#include "body/lay_interfaces.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "body/element.hpp"
#include "body/interface_checks.hpp"
#include "body/layer_geometry.hpp"
#include "sunder/error.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder::fem {
namespace {

constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};  // seen from outside

/// A layer is thin against what opens it and against its faces, and not so thin that its own
/// geometry drowns in rounding.
constexpr double kOfOpening = 1e-2, kOfEdge = 2e-2, kLeastOfEdge = 1e-4;
/// Of the shortest edge: an opening that no mesh resolves.
constexpr double kLeastOpening = 1e-6;

std::size_t u(Index i) { return static_cast<std::size_t>(i); }

/// A face of an interface, by the element on the side of `between[0]`.
struct LayerFace {
  std::size_t interface = 0;
  std::array<Index, 3> nodes{};       // of the mesh, normal to the other side
  std::array<Index, 2> elements{};    // of both sides
  std::array<Index, 3> lower, upper;  // copies of the nodes, by side
};

class Laying {
 public:
  explicit Laying(Scene& scene) : scene_(scene), mesh_(scene.mesh) {}

  void run() {
    find_faces();
    find_thickness();
    part_nodes();
    move_apart();
    add_layers();
    check_elements();
    copy_surfaces();
    for (std::size_t i = 0; i < scene_.interfaces.size(); ++i) take_as_it_is(i);
  }

 private:
  /// A layer that the mesh has already.
  void take_as_it_is(std::size_t i) {
    if (first_side_.contains(i) || scene_.materials.contains(interface_volume(i))) return;
    const auto first = nodes_of_volume(mesh_, scene_.interfaces[i].between[0]);
    double volume = 0, area = 0;
    for (std::size_t e = 0; e < mesh_.tets.size(); ++e) {
      if (mesh_.volumes[u(mesh_.volume_of[e])].name != interface_volume(i)) continue;
      const auto& t = mesh_.tets[e];
      const auto& x = mesh_.nodes;
      const TetShape shape = tet_shape(x[u(t[0])], x[u(t[1])], x[u(t[2])], x[u(t[3])]);
      volume += shape.volume;
      area += shape.volume * slope_across(shape, t, first).norm();
    }
    thickness_[i] = volume / area;
    scene_.materials[interface_volume(i)] = material(i);
  }

  [[nodiscard]] std::array<Index, 3> sorted_face(Index e, std::size_t face) const {
    std::array<Index, 3> nodes{};
    for (std::size_t k = 0; k < 3; ++k) nodes[k] = mesh_.tets[u(e)][kFaces[face][k]];
    std::ranges::sort(nodes);
    return nodes;
  }

  [[nodiscard]] std::vector<std::uint8_t> nodes_of_several_volumes() const {
    std::vector<Index> first(mesh_.nodes.size(), kNone);
    std::vector<std::uint8_t> several(mesh_.nodes.size(), 0);
    for (Index e = 0; e < mesh_.tet_count(); ++e) {
      for (Index n : mesh_.tets[u(e)]) {
        if (first[u(n)] == kNone) first[u(n)] = mesh_.volume_of[u(e)];
        if (first[u(n)] != mesh_.volume_of[u(e)]) several[u(n)] = 1;
      }
    }
    return several;
  }

  void find_faces() {
    std::map<std::string, Index, std::less<>> volume;
    for (std::size_t v = 0; v < mesh_.volumes.size(); ++v) {
      volume[mesh_.volumes[v].name] = static_cast<Index>(v);
    }
    std::map<std::array<Index, 2>, std::size_t> sides;
    for (std::size_t i = 0; i < scene_.interfaces.size(); ++i) {
      if (is_laid(scene_, i)) continue;
      const auto& between = scene_.interfaces[i].between;
      const Index a = volume.at(between[0]), b = volume.at(between[1]);
      sides[{a, b}] = sides[{b, a}] = i;
      first_side_.emplace(i, a);
    }
    const std::vector<std::uint8_t> shared = nodes_of_several_volumes();
    std::map<std::array<Index, 3>, std::array<Index, 2>> seen;  // element, face
    std::map<std::size_t, Index> count;
    for (Index e = 0; e < mesh_.tet_count(); ++e) {
      const Index own = mesh_.volume_of[u(e)];
      for (std::size_t f = 0; f < 4; ++f) {
        const std::array<Index, 3> key = sorted_face(e, f);
        if (!std::ranges::all_of(key, [&](Index n) { return shared[u(n)] != 0; })) continue;
        const auto [at, fresh] = seen.try_emplace(key, std::array{e, static_cast<Index>(f)});
        if (fresh) continue;
        const auto pair = sides.find({mesh_.volume_of[u(at->second[0])], own});
        if (pair == sides.end()) continue;
        LayerFace face;
        face.interface = pair->second;
        const bool lower = first_side_.at(face.interface) == own;
        const Index below = lower ? e : at->second[0];
        const std::size_t corner = lower ? f : u(at->second[1]);
        face.elements = {below, lower ? at->second[0] : e};
        for (std::size_t k = 0; k < 3; ++k) {
          face.nodes[k] = mesh_.tets[u(below)][kFaces[corner][k]];
        }
        faces_.push_back(face);
        ++count[face.interface];
      }
    }
    for (const auto& [i, side] : first_side_) {
      if (count[i] > 0) continue;
      throw InputError(InputFault::empty_selection,
                       interface_name(scene_, i) + " lies nowhere: the two volumes share no face");
    }
  }

  /// One for all that are laid, the thinnest: where two meet, both have their copies at its
  /// distance.
  void find_thickness() {
    if (first_side_.empty()) return;
    double shortest = std::numeric_limits<double>::infinity(), thickness = shortest;
    for (const LayerFace& face : faces_) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 edge = mesh_.nodes[u(face.nodes[k])] - mesh_.nodes[u(face.nodes[(k + 1) % 3])];
        shortest = std::min(shortest, edge.norm());
      }
    }
    for (const auto& [i, side] : first_side_) {
      const Interface& of = scene_.interfaces[i];
      const double opening = 2 * of.energy / of.strength;
      if (!(opening >= kLeastOpening * shortest)) {
        throw InputError(InputFault::out_of_range,
                         interface_name(scene_, i) + " has energy = " + in_digits(of.energy) +
                             " N/mm, with which it parts at an opening of " + in_digits(opening) +
                             " mm (2 energy / strength): nothing beside its shortest edge of " +
                             in_digits(shortest) +
                             " mm; take more energy, less strength, or join "
                             "the volumes");
      }
      thickness = std::min(thickness, kOfOpening * opening);
    }
    thickness = std::clamp(thickness, kLeastOfEdge * shortest, kOfEdge * shortest);
    for (const auto& [i, side] : first_side_) thickness_[i] = thickness;
  }

  /// A node becomes as many as its elements hang together by faces that lie in no interface.
  void part_nodes() {
    std::set<std::array<Index, 3>> cut;
    std::map<Index, std::vector<Index>> around;
    for (const LayerFace& face : faces_) {
      auto key = face.nodes;
      std::ranges::sort(key);
      cut.insert(key);
      for (Index n : face.nodes) around[n];
    }
    for (Index e = 0; e < mesh_.tet_count(); ++e) {
      for (Index n : mesh_.tets[u(e)]) {
        const auto at = around.find(n);
        if (at != around.end()) at->second.push_back(e);
      }
    }
    for (const auto& [node, elements] : around) part(node, elements, cut);
  }

  void part(Index node, const std::vector<Index>& elements,
            const std::set<std::array<Index, 3>>& cut) {
    std::vector<std::size_t> group(elements.size());
    for (std::size_t i = 0; i < group.size(); ++i) group[i] = i;
    const auto root = [&](std::size_t i) {
      while (group[i] != i) i = group[i] = group[group[i]];
      return i;
    };
    std::map<std::array<Index, 3>, std::size_t> seen;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      for (std::size_t f = 0; f < 4; ++f) {
        const std::array<Index, 3> key = sorted_face(elements[i], f);
        if (std::ranges::find(key, node) == key.end() || cut.contains(key)) continue;
        const auto [at, fresh] = seen.try_emplace(key, i);
        if (fresh) continue;
        const std::size_t a = root(at->second), b = root(i);
        group[std::max(a, b)] = std::min(a, b);
      }
    }
    // What hangs on the rest by an edge or the node alone stays with its own volume.
    std::vector<std::uint8_t> faces(elements.size(), 0);
    for (std::size_t i = 0; i < elements.size(); ++i) {
      for (std::size_t f = 0; f < 4; ++f) {
        const std::array<Index, 3> key = sorted_face(elements[i], f);
        if (std::ranges::find(key, node) != key.end() && cut.contains(key)) faces[root(i)] = 1;
      }
    }
    std::map<std::size_t, Index> copy;
    std::map<Index, Index> of_volume;  // the first copy that its groups with faces have
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if (faces[root(i)] == 0 || copy.contains(root(i))) continue;
      copy[root(i)] = copy.empty() ? node : new_node(node);
      of_volume.emplace(mesh_.volume_of[u(elements[i])], copy[root(i)]);
    }
    for (std::size_t i = 0; i < elements.size(); ++i) {
      const auto own = of_volume.find(mesh_.volume_of[u(elements[i])]);
      const Index hangs = own == of_volume.end() ? node : own->second;
      copies_[{elements[i], node}] = faces[root(i)] != 0 ? copy.at(root(i)) : hangs;
    }
  }

  Index new_node(Index of) {
    mesh_.nodes.push_back(Vec3(mesh_.nodes[u(of)]));
    const Index added = mesh_.node_count() - 1;
    origin_[added] = of;
    return added;
  }

  [[nodiscard]] Index copy(Index element, Index node) const {
    const auto at = copies_.find({element, node});
    return at == copies_.end() ? node : at->second;
  }

  /// New nodes move so far that each face's copies lie its layer's thickness apart, along the
  /// normal of the face as nearly as all faces at the node allow (least squares).
  void move_apart() {
    std::map<Index, std::vector<std::size_t>> at_node;  // faces
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      LayerFace& face = faces_[f];
      for (std::size_t k = 0; k < 3; ++k) {
        face.lower[k] = copy(face.elements[0], face.nodes[k]);
        face.upper[k] = copy(face.elements[1], face.nodes[k]);
        at_node[face.nodes[k]].push_back(f);
      }
    }
    std::vector<std::pair<Index, Vec3>> moves;
    for (const auto& [node, of_faces] : at_node) move_copies(node, of_faces, moves);
    for (const auto& [node, by] : moves) mesh_.nodes[u(node)] += by;
    for (const auto& [at, node] : copies_) {
      const auto& [element, from] = at;
      std::ranges::replace(mesh_.tets[u(element)], from, node);
    }
  }

  void move_copies(Index node, const std::vector<std::size_t>& of_faces,
                   std::vector<std::pair<Index, Vec3>>& moves) const {
    std::map<Index, Eigen::Index> column;
    const auto sides = [&](std::size_t f) {
      const LayerFace& face = faces_[f];
      const auto k =
          u(static_cast<Index>(std::ranges::find(face.nodes, node) - face.nodes.begin()));
      return std::array{face.lower[k], face.upper[k]};
    };
    for (std::size_t f : of_faces) {
      for (Index n : sides(f)) {
        if (n != node) column.try_emplace(n, 3 * static_cast<Eigen::Index>(column.size()));
      }
    }
    if (column.empty()) return;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(of_faces.size()),
                                              3 * static_cast<Eigen::Index>(column.size()));
    Eigen::VectorXd b = Eigen::VectorXd::Zero(a.rows());
    for (Eigen::Index row = 0; row < a.rows(); ++row) {
      const std::size_t f = of_faces[static_cast<std::size_t>(row)];
      const auto& [lower, upper] = sides(f);
      if (lower == upper) continue;
      const Vec3 normal = normal_of(faces_[f]);
      const double weight = std::sqrt(normal.norm());
      const Eigen::RowVector3d unit = weight * normal.normalized().transpose();
      if (upper != node) a.block<1, 3>(row, column.at(upper)) += unit;
      if (lower != node) a.block<1, 3>(row, column.at(lower)) -= unit;
      b[row] = weight * thickness_.at(faces_[f].interface);
    }
    // Normals of nearly flat surroundings span one direction, whatever rounding says of the others.
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> of;
    of.setThreshold(0.05);
    of.compute(a);
    const Eigen::VectorXd v = of.solve(b);
    for (const auto& [n, at] : column) moves.emplace_back(n, v.segment<3>(at));
  }

  /// Twice its area long, to the upper side. Of the mesh as it came.
  [[nodiscard]] Vec3 normal_of(const LayerFace& face) const {
    const auto x = [&](std::size_t k) { return mesh_.nodes[u(face.nodes[k])]; };
    return (x(1) - x(0)).cross(x(2) - x(0));
  }

  /// A prism as three tetrahedra. Their diagonals go by the nodes' numbers, so that those of
  /// neighbouring faces meet.
  void add_layers() {
    const std::size_t before = mesh_.tets.size();
    for (const auto& [i, side] : first_side_) {
      const auto volume = static_cast<Index>(mesh_.volumes.size());
      int tag = 0;
      for (const NamedVolume& v : mesh_.volumes) tag = std::max(tag, v.tag);
      mesh_.volumes.push_back({interface_volume(i), tag + 1});
      for (const LayerFace& face : faces_) {
        if (face.interface != i) continue;
        std::array<std::size_t, 3> order{0, 1, 2};
        std::ranges::sort(order, {}, [&](std::size_t k) { return face.nodes[k]; });
        const bool turned = (order[1] + 3 - order[0]) % 3 == 2;
        std::array<Index, 3> a{}, b{};
        for (std::size_t k = 0; k < 3; ++k) {
          a[k] = face.lower[order[k]];
          b[k] = face.upper[order[k]];
        }
        // Where the interface ends inside of the body both sides have a node in common, and no
        // spring.
        if (a[2] != b[2]) add({a[0], a[1], a[2], b[2]}, volume, turned);
        if (a[1] != b[1]) add({a[0], a[1], b[1], b[2]}, volume, !turned);
        if (a[0] != b[0]) add({a[0], b[0], b[1], b[2]}, volume, turned);
      }
      scene_.materials[interface_volume(i)] = material(i);
    }
    for (auto& [name, field] : mesh_.fields) {
      if (field.size() == before) field.resize(mesh_.tets.size(), Vec3::Zero());  // others: refused
    }
  }

  void add(std::array<Index, 4> tet, Index volume, bool turned) {
    if (turned) std::swap(tet[0], tet[1]);
    mesh_.tets.push_back(tet);
    mesh_.volume_of.push_back(volume);
  }

  /// None may be turned inside out by the thickness that the layers take.
  void check_elements() const {
    const auto& x = mesh_.nodes;
    for (Index e = 0; e < mesh_.tet_count(); ++e) {
      const auto& t = mesh_.tets[u(e)];
      if (tet_shape(x[u(t[0])], x[u(t[1])], x[u(t[2])], x[u(t[3])]).volume > 0) continue;
      throw InputError(InputFault::degenerate_element,
                       "[[interface]] leaves no room for the element at " + place(x[u(t[0])]) +
                           ": it is flat, or the interface bends sharply there; mesh it finer");
    }
  }

  [[nodiscard]] Material material(std::size_t i) const {
    const Interface& of = scene_.interfaces[i];
    Material layer;
    layer.young = 2 * layer_law(of.strength, of.energy, thickness_.at(i)).mu;
    layer.law = MaterialLaw::neo_hookean;
    layer.yield = of.strength;
    for (const std::string& side : of.between) {
      const auto beside = scene_.materials.find(side);
      if (beside == scene_.materials.end() || !beside->second.density) continue;
      layer.density =
          std::min(layer.density.value_or(*beside->second.density), *beside->second.density);
    }
    return layer;
  }

  /// Triangles of a surface follow the first element that has them.
  void copy_surfaces() {
    std::set<Index> parted;
    for (const auto& [added, node] : origin_) parted.insert(node);
    const auto touched = [&](const std::array<Index, 3>& triangle) {
      return std::ranges::any_of(triangle, [&](Index n) { return parted.contains(n); });
    };
    std::map<std::array<Index, 3>, std::vector<std::array<Index, 3>*>> triangles;
    for (NamedSurface& surface : mesh_.surfaces) {
      for (auto& triangle : surface.triangles) {
        auto key = triangle;
        std::ranges::sort(key);
        if (touched(triangle)) triangles[key].push_back(&triangle);
      }
    }
    for (Index e = 0; e < mesh_.tet_count() && !triangles.empty(); ++e) {
      for (const auto& corners : kFaces) {
        std::array<Index, 3> key{};
        for (std::size_t k = 0; k < 3; ++k) {
          const Index node = mesh_.tets[u(e)][corners[k]];
          const auto at = origin_.find(node);
          key[k] = at == origin_.end() ? node : at->second;
        }
        if (!touched(key)) continue;
        std::ranges::sort(key);
        const auto at = triangles.find(key);
        if (at == triangles.end()) continue;
        for (auto* triangle : at->second) {
          for (Index& n : *triangle) n = copy(e, n);
        }
        triangles.erase(at);
      }
    }
  }

  Scene& scene_;
  Mesh& mesh_;
  std::map<std::size_t, Index> first_side_;  // of interfaces to lay: volume of between[0]
  std::map<std::size_t, double> thickness_;
  std::vector<LayerFace> faces_;
  std::map<std::array<Index, 2>, Index> copies_;  // of element and node
  std::map<Index, Index> origin_;                 // of new nodes
};

}  // namespace

void lay_interfaces(Scene& scene) {
  if (scene.interfaces.empty()) return;
  check_interfaces(scene);
  Laying(scene).run();
}

}  // namespace sunder::fem
