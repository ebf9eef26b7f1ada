// SPDX-License-Identifier: Apache-2.0
#include "core/field_sif/cracked_board.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

namespace sunder::test {
namespace {

Index lines_count(const std::vector<double>& lines) { return static_cast<Index>(lines.size()); }

Index grid_place(const GridLines& g, Index i, Index j, Index k) {
  return i + lines_count(g.x) * (j + lines_count(g.y) * k);
}

/// Kuhn's six tetrahedra of a cell, mirrored along each axis in every other cell; along y counted
/// from the middle row, so that meshes of all sizes look alike around the crack.
void add_cell(const GridLines& g, Index i, Index j, Index k, Mesh& mesh) {
  static constexpr int kPaths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1},
                                       {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  const std::array<Index, 3> cell{i, j, k};
  const std::array<Index, 3> parity{i % 2, (j + (lines_count(g.y) - 1) / 2) % 2, k % 2};
  for (const auto& path : kPaths) {
    std::array<Index, 3> offset{0, 0, 0};
    std::array<Index, 4> tet{};
    for (int corner = 0; corner < 4; ++corner) {
      if (corner > 0) ++offset[path[corner - 1]];
      std::array<Index, 3> at{};
      for (int axis = 0; axis < 3; ++axis)
        at[axis] = cell[axis] + (parity[axis] ? 1 - offset[axis] : offset[axis]);
      tet[corner] = grid_place(g, at[0], at[1], at[2]);
    }
    const auto& x = mesh.nodes;
    const Vec3 a = x[tet[1]] - x[tet[0]], b = x[tet[2]] - x[tet[0]], c = x[tet[3]] - x[tet[0]];
    if (a.cross(b).dot(c) < 0) std::swap(tet[0], tet[1]);
    mesh.tets.push_back(tet);
    mesh.volume_of.push_back(0);
  }
}

Vec3 centroid(const Mesh& mesh, const std::array<Index, 4>& tet) {
  Vec3 sum = Vec3::Zero();
  for (Index n : tet) sum += mesh.nodes[n];
  return sum / 4;
}

/// Elements above the line get copies of the nodes on it. Ends inside the board stay whole.
void split_nodes(Mesh& mesh, double from, double to, double y, double left, double right) {
  std::map<Index, Index> copy;
  const Index count = mesh.node_count();
  for (Index n = 0; n < count; ++n) {
    const Vec3 x = mesh.nodes[n];
    const bool after = from <= left + kClose ? x.x() > from - kClose : x.x() > from + kClose;
    const bool before = to >= right - kClose ? x.x() < to + kClose : x.x() < to - kClose;
    if (std::abs(x.y() - y) > kClose || !after || !before) continue;
    copy[n] = mesh.node_count();
    mesh.nodes.push_back(x);
  }
  for (auto& tet : mesh.tets)
    if (centroid(mesh, tet).y() > y)
      for (Index& n : tet)
        if (const auto it = copy.find(n); it != copy.end()) n = it->second;
}

std::vector<Index> nodes_where(const Mesh& mesh, const std::function<bool(const Vec3&)>& holds) {
  std::vector<Index> nodes;
  for (Index n = 0; n < mesh.node_count(); ++n)
    if (holds(mesh.nodes[n])) nodes.push_back(n);
  return nodes;
}

/// Shifts inner nodes at random, the same on every machine.
void shake(const GridLines& g, double jitter, Mesh& mesh) {
  std::mt19937 random(12345);
  const auto shift = [&] { return (random() / 4294967295.0 * 2 - 1) * jitter; };
  for (Vec3& x : mesh.nodes) {
    const Vec3 before = x;
    const bool inside = x.x() > g.x.front() + kClose && x.x() < g.x.back() - kClose &&
                        x.y() > g.y.front() + kClose && x.y() < g.y.back() - kClose;
    if (inside) x = before + Vec3(shift(), shift(), 0);
  }
}

Support hold(std::vector<Index> nodes, Axes axes) {
  Support support;
  support.nodes = std::move(nodes);
  support.axes = axes;
  return support;
}

/// Three nodes keep the board from moving without keeping it from straining.
std::vector<Support> supports(const GridLines& g, const Mesh& mesh,
                              const CrackedBoardOptions& options) {
  const Index nx = lines_count(g.x) - 1, ny = lines_count(g.y) - 1;
  std::vector<Support> held;
  const Index lower_right = grid_place(g, nx, 0, 0), upper_right = grid_place(g, nx, ny, 0);
  held.push_back(hold({lower_right}, Axes{6}));
  held.push_back(hold({upper_right, grid_place(g, 0, 0, 0)}, Axes{4}));
  held.push_back(
      hold(options.mirror_left
               ? nodes_where(mesh, [&](const Vec3& x) { return x.x() < g.x.front() + kClose; })
               : std::vector<Index>{lower_right, upper_right},
           Axes{1}));
  if (options.held_flat)
    held.push_back(hold(nodes_where(mesh, [](const Vec3&) { return true; }), Axes{4}));
  if (options.held_in_plane)
    held = {hold(nodes_where(mesh, [](const Vec3&) { return true; }), Axes{3}),
            hold({lower_right}, Axes{4})};
  return held;
}

Scene board_scene(const GridLines& lines, double from, double to, double y,
                  const CrackedBoardOptions& options) {
  Scene scene;
  scene.mesh = grid_mesh(lines);
  if (options.made == CrackMade::split)
    split_nodes(scene.mesh, from, to, y, lines.x.front(), lines.x.back());
  if (options.jitter > 0) shake(lines, options.jitter, scene.mesh);
  scene.materials["board"] = {options.young, options.poisson, 2.0, options.law};
  scene.materials["board"].volume = options.volume;
  scene.supports = supports(lines, scene.mesh, options);
  scene.fracture.alpha = options.alpha;
  return scene;
}

/// The row of cells around y between two x. Which elements the crack takes is the grid's matter;
/// where their nodes are may have been shaken.
std::vector<Index> row_elements(const GridLines& lines, double from, double to, double y) {
  const auto above = std::upper_bound(lines.y.begin(), lines.y.end(), y);
  const double row_min = *(above - 1), row_max = *above;
  const Mesh mesh = grid_mesh(lines);
  std::vector<Index> elements;
  for (Index e = 0; e < mesh.tet_count(); ++e) {
    const Vec3 c = centroid(mesh, mesh.tets[e]);
    if (c.x() > from && c.x() < to && c.y() > row_min && c.y() < row_max) elements.push_back(e);
  }
  return elements;
}

}  // namespace

std::vector<double> even_lines(int count, double h) {
  std::vector<double> lines;
  for (int i = 0; i <= count; ++i) lines.push_back(i * h);
  return lines;
}

std::vector<double> graded_lines(double h, double fine, double half, double growth) {
  std::vector<double> positive{h / 2};  // a row of cells around 0
  double step = h;
  while (positive.back() + step * growth < half) {
    if (positive.back() >= fine) step *= growth;
    positive.push_back(positive.back() + step);
  }
  positive.back() = half;
  std::vector<double> lines;
  for (auto it = positive.rbegin(); it != positive.rend(); ++it) lines.push_back(-*it);
  lines.insert(lines.end(), positive.begin(), positive.end());
  return lines;
}

Index grid_node_count(const Mesh& mesh) {
  // Nodes of the grid ascend by z, then y, then x; the first that does not is a copy.
  const auto before = [](const Vec3& a, const Vec3& b) {
    return std::array{a.z(), a.y(), a.x()} < std::array{b.z(), b.y(), b.x()};
  };
  const auto end = std::is_sorted_until(mesh.nodes.begin(), mesh.nodes.end(), before);
  return static_cast<Index>(end - mesh.nodes.begin());
}

Mesh grid_mesh(const GridLines& g) {
  Mesh mesh;
  mesh.volumes.push_back({"board", 1});
  for (double z : g.z)
    for (double y : g.y)
      for (double x : g.x) mesh.nodes.emplace_back(x, y, z);
  for (Index k = 0; k + 1 < lines_count(g.z); ++k)
    for (Index j = 0; j + 1 < lines_count(g.y); ++j)
      for (Index i = 0; i + 1 < lines_count(g.x); ++i) add_cell(g, i, j, k, mesh);
  return mesh;
}

CrackedBoard::CrackedBoard(const GridLines& lines, double from, double to, double y,
                           const CrackedBoardOptions& options)
    : CrackedBody(board_scene(lines, from, to, y, options)), y_(y) {
  const bool edge = from <= lines.x.front() + kClose;
  const auto elements =
      options.made == CrackMade::deleted ? row_elements(lines, from, to, y) : std::vector<Index>{};
  set_crack(edge ? CrackKind::edge : CrackKind::internal, {from, y}, {to, y}, elements);
}

void CrackedBoard::load_antiplane(double s_yz) {
  const auto& x = problem().mesh().nodes;
  double top = 0;
  for (const Vec3& p : x) top = std::max(top, p.y());
  for (const FreeFace& face : free_faces(problem().mesh())) {
    const auto& [a, b, c] = face.nodes;
    const Vec3 area = (x[b] - x[a]).cross(x[c] - x[a]) / 2;
    const double y = (x[a] + x[b] + x[c]).y() / 3;
    if (std::abs(std::abs(y) - top) > kClose) continue;
    for (Index n : face.nodes) add_force(n, Vec3(0, 0, s_yz * area.y() / 3));
  }
}

void CrackedBoard::load_pair(double at, double per_thickness) {
  // The nodes of the faces nearest above and below the crack's line, each with its share of the
  // thickness.
  const auto& x = problem().mesh().nodes;
  double face = 1e300;
  for (const Vec3& p : x)
    if (std::abs(p.x() - at) < kClose) face = std::min(face, std::abs(p.y() - y_));
  std::vector<double> z;
  for (const Vec3& p : x)
    if (std::abs(p.x() - at) < kClose && std::abs(p.y() - y_ - face) < kClose) z.push_back(p.z());
  std::sort(z.begin(), z.end());
  for (Index n = 0; n < problem().node_count(); ++n) {
    const Vec3& p = x[n];
    const double offset = p.y() - y_;
    if (std::abs(p.x() - at) > kClose || std::abs(std::abs(offset) - face) > kClose) continue;
    const auto k = std::lower_bound(z.begin(), z.end(), p.z() - kClose);
    const double below = k == z.begin() ? *k : *(k - 1), above = k + 1 == z.end() ? *k : *(k + 1);
    const Vec3 force(0, (offset > 0 ? 1 : -1) * per_thickness * (above - below) / 2, 0);
    add_force(n, force);
    crack_forces_.push_back({n, force});
  }
}

}  // namespace sunder::test
