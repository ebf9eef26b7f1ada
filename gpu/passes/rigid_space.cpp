// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/rigid_space.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>

#include "body/element.hpp"
#include "body/pools.hpp"
#include "body/supports.hpp"
#include "material/singular_values.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Groups, at most: of a body at rest one for so many nodes where that is more, as iterations grow
// with the square root of a group's size; their product then reads an eighth of what K's does.
// Of a board of 979,200 tetrahedra 64, 256 and 512 groups take 1340, 449 and 282 iterations, of a
// block of 998,250 342, 269 and 186; a matrix of 512 takes seconds to invert.
constexpr Index kMost = 64, kNodesOfALargeGroup = 160, kMostOfALargeBody = 512;
constexpr Index kNodesPerGroup = 64;  // of the largest body, until there are too many groups
// Where groups are kept apart: of the 1944-element board's steps in motion 64, 24 and 10 take 746,
// 407 and 140 ms on lavapipe.
constexpr Index kNodesPerGroupApart = 10;
constexpr Index kFewest = 4;  // nodes of a body worth a group: below, D alone is exact enough
// Added to the diagonal of Z^T K Z, in shares of its largest entry: motions that supports take away
// leave zeros there.
constexpr double kShift = 1e-13;
// Another inertia than so many times or a part of it is another body's.
constexpr double kMostInertiaApart = 4;

Index most_groups(const Problem& problem, bool apart) {
  const Index many = problem.node_count() / kNodesOfALargeGroup / 2 * 2;
  return apart ? kMost : std::clamp(many, kMost, kMostOfALargeBody);
}

/// Rows and columns that there is room for: whole packs of terms.
std::size_t coarse_size(Index groups) {
  return round_up(6 * static_cast<std::uint32_t>(groups), 16);
}

// Texels of four words.
constexpr std::size_t kTexel = 4 * sizeof(std::uint32_t);

}  // namespace

RigidSpace::RigidSpace(const KernelFactory& kernels, const Problem& problem,
                       std::span<const std::uint8_t> destroyed, double share, bool apart)
    : kernels_(kernels),
      problem_(problem),
      most_(most_groups(problem, apart)),
      destroyed_(destroyed),
      share_(share),
      held_(problem_.mesh().nodes.size(), 0) {
  if (apart) kind_ = kinds_of_nodes();
  hold(problem.gripped_dofs());
  const std::size_t nodes =
      round_up(static_cast<std::uint32_t>(problem.node_count()), shaders::kGroup);
  const auto make = [&](std::size_t bytes, Placement placement) {
    Buffer buffer(kernels.device(), bytes, placement);
    buffer.fill_zero();
    return buffer;
  };
  modes_ = make(nodes * kTexel, Placement::device);
  const std::size_t size = coarse_size(most_), groups = size / 6 + 1;
  first_ = make((groups + 1) * sizeof(std::uint32_t), Placement::device);
  members_ = make(nodes * kTexel, Placement::device);
  inverse_ = make(size * size * sizeof(double), Placement::device);
  y_ = make(size * sizeof(double), Placement::device);
  w_ = make(groups * 8 * sizeof(double), Placement::device);
  terms_ = make(size / 4 * sizeof(double), Placement::device);
}

std::size_t RigidSpace::planned_groups(const Problem& problem) {
  return static_cast<std::size_t>(
      std::clamp<Index>(problem.node_count() / kNodesPerGroup, 1, most_groups(problem, false)));
}

std::size_t RigidSpace::planned_bytes(const Problem& problem, bool apart) {
  const std::size_t size = coarse_size(most_groups(problem, apart)), groups = size / 6 + 1;
  const std::size_t nodes =
      round_up(static_cast<std::uint32_t>(problem.node_count()), shaders::kGroup);
  return 2 * nodes * kTexel + Buffer::padded((groups + 1) * sizeof(std::uint32_t)) +
         (size + 1) * size * sizeof(double) + groups * 8 * sizeof(double) +
         size / 4 * sizeof(double);
}

std::size_t RigidSpace::bytes() const {
  return modes_.bytes() + first_.bytes() + members_.bytes() + inverse_.bytes() + y_.bytes() +
         w_.bytes() + terms_.bytes();
}

void RigidSpace::bind(const Buffer& r) {
  const std::uint32_t group = kernels_.summing_group();
  restrict_ = kernels_.in_fp64().make("cg_restrict", group);
  const Buffer* restricted[] = {&first_, &members_, &r, &y_};
  restrict_binding_ = std::make_unique<vulkan::Binding>(kernels_.device(), *restrict_, restricted);
  solve_ = kernels_.in_fp64().make("cg_coarse", group);
  const Buffer* solved[] = {&inverse_, &y_, &w_, &terms_};
  solve_binding_ = std::make_unique<vulkan::Binding>(kernels_.device(), *solve_, solved);
}

void RigidSpace::record(vulkan::Commands& commands, const shaders::CgPush& push) const {
  commands.dispatch(*restrict_binding_, groups());
  commands.dispatch(*solve_binding_, push, solve_groups());
}

void RigidSpace::record_indirect(vulkan::Commands& commands, const shaders::CgPush& push,
                                 const Buffer& arguments) const {
  commands.dispatch_indirect(*restrict_binding_, arguments, 3 * sizeof(std::uint32_t));
  commands.dispatch_indirect(*solve_binding_, push, arguments, 6 * sizeof(std::uint32_t));
}

/// By supports and these unknowns, ascending.
void RigidSpace::hold(std::span<const Index> gripped) {
  for (Index n = 0; n < problem_.node_count(); ++n) {
    held_[n] = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Index dof = problem_.dof(n, axis);
      if (dof == kNone || std::ranges::binary_search(gripped, dof)) {
        held_[n] |= static_cast<std::uint8_t>(1 << axis);
      }
    }
  }
}

void RigidSpace::destroy(std::span<const Index> elements) {
  for (Index e : elements) {
    if (coarse_.size() > 0) add_element(e, share_ - 1);
  }
  changed_ = true;
}

void RigidSpace::grip(std::span<const Index> gripped) {
  std::vector<Index> ascending(gripped.begin(), gripped.end());
  std::ranges::sort(ascending);
  hold(ascending);
  forget();
}

void RigidSpace::forget() {
  groups_.clear();
  coarse_.resize(0, 0);
  changed_ = true;
}

void RigidSpace::set_inertia(const fem::Inertia& inertia) {
  const bool alike = inertia_.factor <= kMostInertiaApart * inertia.factor &&
                     inertia.factor <= kMostInertiaApart * inertia_.factor;
  if (alike && mass_.size() == inertia.mass.size()) return;
  mass_.assign(inertia.mass.begin(), inertia.mass.end());
  inertia_ = {inertia.factor, mass_};
  changed_ = true;
}

/// A node's is the stiffest of its elements', by the shear modulus.
std::vector<Index> RigidSpace::kinds_of_nodes() const {
  std::vector<double> stiffest(problem_.mesh().nodes.size(), 0.0);
  for (Index e = 0; e < problem_.tet_count(); ++e) {
    for (Index n : problem_.mesh().tets[e]) {
      stiffest[n] = std::max(stiffest[n], problem_.small_strain(e).mu);
    }
  }
  std::vector<Index> kinds;
  for (const double mu : stiffest) kinds.push_back(mu > 0 ? std::ilogb(mu) : 0);
  return kinds;
}

void RigidSpace::update(std::span<const double> u) {
  update();
  if (groups_.empty() || std::ranges::equal(u, shown_)) return;
  shown_.assign(u.begin(), u.end());
  place_modes(u);
  turn(u);
}

/// The inverse by the rotations of the groups from where they rest.
void RigidSpace::turn(std::span<const double> u) {
  if (resting_inverse_.size() == 0) return;
  Eigen::MatrixXd turned = resting_inverse_;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    Vec3 mean = Vec3::Zero();
    for (Index n : groups_[g]) mean += Vec3(&u[3 * static_cast<std::size_t>(n)]);
    mean /= static_cast<double>(groups_[g].size());
    Mat3 sum = Mat3::Zero();
    for (Index n : groups_[g]) {
      const Vec3 from = place_[n] * size_[g];
      sum += (from + Vec3(&u[3 * static_cast<std::size_t>(n)]) - mean) * from.transpose();
    }
    const Mat3 q = nearest_rotation(sum);
    for (int half = 0; half < 2; ++half) {
      const auto at = static_cast<Eigen::Index>(6 * g) + 3 * half;
      turned.middleRows<3>(at) = (q * turned.middleRows<3>(at)).eval();
      turned.middleCols<3>(at) = (turned.middleCols<3>(at) * q.transpose()).eval();
    }
  }
  upload_inverse(turned);
}

void RigidSpace::update() {
  if (!changed_) return;
  changed_ = false;
  shown_.clear();
  std::vector<std::vector<Index>> groups = grouped();
  if (groups != groups_) {
    groups_ = std::move(groups);
    place_modes({});
    const auto size = 6 * static_cast<Index>(groups_.size());
    coarse_.setZero(size, size);
    for (Index e = 0; e < problem_.tet_count(); ++e) {
      add_element(e, destroyed_[e] ? share_ : 1);
    }
    for (Index p = 0; problem_.pools() && p < problem_.pools()->count(); ++p) add_patch(p);
  } else if (most_ > kMost && resting_inverse_.size() > 0 && !(inertia_.factor > 0)) {
    return;  // a large one stays as it is: a cut nearly through a board costs 3 % more iterations
  }
  invert();
}

/// The largest body by its extent in parts of some 64 nodes, every other body whole.
std::vector<std::vector<Index>> RigidSpace::grouped() {
  const auto bodies = fem::find_bodies(problem_.mesh(), destroyed_);
  std::vector<std::vector<Index>> nodes(static_cast<std::size_t>(bodies.count));
  for (Index n = 0; n < problem_.node_count(); ++n) {
    const Index body = bodies.body_of_node[n];
    if (body != kNone) nodes[body].push_back(n);
  }
  std::stable_sort(nodes.begin(), nodes.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::erase_if(nodes, [](const auto& body) { return body.size() < kFewest; });
  std::vector<std::vector<Index>> groups;
  if (nodes.empty()) return groups;
  const auto others = std::min<Index>(static_cast<Index>(nodes.size()) - 1, most_ / 2);
  const auto wanted = std::max<Index>(static_cast<Index>(nodes.front().size()) / kNodesPerGroup, 1);
  if (kind_.empty()) {
    split(nodes.front(), std::min(wanted, most_ - others), groups);
  } else {
    std::map<Index, std::vector<Index>> by_kind;
    for (Index n : nodes.front()) by_kind[kind_[n]].push_back(n);
    const auto spare = std::max<Index>(most_ - others - static_cast<Index>(by_kind.size()), 0);
    for (auto& [kind, list] : by_kind) {
      const auto share = static_cast<Index>(spare * list.size() / nodes.front().size());
      split(list,
            std::min(std::max<Index>(static_cast<Index>(list.size()) / kNodesPerGroupApart, 1),
                     1 + share),
            groups);
    }
  }
  for (Index b = 1; b <= others; ++b) groups.push_back(nodes[b]);
  for (auto& group : groups) std::sort(group.begin(), group.end());
  return groups;
}

/// Halves along the longest side of the nodes' box, in proportion to the groups on either side.
void RigidSpace::split(std::span<Index> nodes, Index count,
                       std::vector<std::vector<Index>>& groups) const {
  if (count <= 1 || static_cast<Index>(nodes.size()) < 2 * kFewest) {
    groups.emplace_back(nodes.begin(), nodes.end());
    return;
  }
  const auto& x = problem_.mesh().nodes;
  Vec3 low = x[nodes.front()], high = low;
  for (Index n : nodes) {
    low = low.cwiseMin(x[n]);
    high = high.cwiseMax(x[n]);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::sort(nodes.begin(), nodes.end(), [&](Index a, Index b) {
    return x[a][axis] != x[b][axis] ? x[a][axis] < x[b][axis] : a < b;
  });
  const Index below = count / 2;
  const std::size_t cut =
      nodes.size() * static_cast<std::size_t>(below) / static_cast<std::size_t>(count);
  split(nodes.first(cut), below, groups);
  split(nodes.subspan(cut), count - below, groups);
}

/// At displacement u; empty: undeformed, as Z^T K Z is taken.
void RigidSpace::place_modes(std::span<const double> u) {
  std::vector<Vec3> x = problem_.mesh().nodes;
  for (std::size_t n = 0; n < x.size() && !u.empty(); ++n) x[n] += Vec3(&u[3 * n]);
  const bool rests = u.empty();
  if (rests) {
    group_of_.assign(x.size(), kNone);
    place_.assign(x.size(), Vec3::Zero());
    size_.assign(groups_.size(), 0.0);
  }
  using Texel = std::array<std::uint32_t, 4>;
  std::vector<Texel> modes(modes_.bytes() / kTexel, Texel{0, 0, 0, shaders::kHeld});  // no group
  std::vector<Texel> members;
  std::vector<std::uint32_t> first(coarse_size(most_) / 6 + 2, 0);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    Vec3 centre = Vec3::Zero();
    for (Index n : groups_[g]) centre += x[n];
    centre /= static_cast<double>(groups_[g].size());
    if (rests) {
      for (Index n : groups_[g]) size_[g] = std::max(size_[g], (x[n] - centre).norm());
    }
    const double size = size_[g];
    for (Index n : groups_[g]) {
      group_of_[n] = static_cast<Index>(g);
      // What the device has, to the last bit: Z^T K Z is of the same Z.
      const Eigen::Vector3f place =
          size > 0 ? ((x[n] - centre) / size).cast<float>() : Eigen::Vector3f(0, 0, 0);
      if (rests) place_[n] = place.cast<double>();
      Texel texel{};
      for (int axis = 0; axis < 3; ++axis) texel[axis] = std::bit_cast<std::uint32_t>(place[axis]);
      texel[3] = static_cast<std::uint32_t>(n);
      members.push_back(texel);
      texel[3] = static_cast<std::uint32_t>(8 * g) + held_[n];
      modes[static_cast<std::size_t>(n)] = texel;
    }
    first[g + 1] = static_cast<std::uint32_t>(members.size());
  }
  std::fill(first.begin() + static_cast<std::ptrdiff_t>(groups_.size()) + 1, first.end(),
            static_cast<std::uint32_t>(members.size()));
  modes_.write(std::span<const Texel>(modes));
  members_.write(std::span<const Texel>(members));
  first_.write(std::span<const std::uint32_t>(first));
  if (!rests) return;
  for (Buffer* of_groups : {&y_, &w_, &terms_})
    of_groups->fill_zero();  // of groups no longer there
}

/// Columns: the node's part in three shifts and three rotations of its group; 0 on held axes.
Eigen::Matrix<double, 3, 6> RigidSpace::motion(Index node) const {
  const Vec3& p = place_[node];
  Eigen::Matrix<double, 3, 6> m;
  m << Mat3::Identity(),
      (Mat3() << 0, p.z(), -p.y(), -p.z(), 0, p.x(), p.y(), -p.x(), 0).finished();
  for (int axis = 0; axis < 3; ++axis) {
    if (held_[node] >> axis & 1) m.row(axis).setZero();
  }
  return m;
}

/// `scale` times the element's share of Z^T K Z.
void RigidSpace::add_element(Index element, double scale) {
  const auto& tet = problem_.mesh().tets[element];
  const TetShape& shape = problem_.shape(element);
  const SmallStrain law = fem::own_law(problem_, element);
  const double mu = law.mu, lambda = law.lambda;
  const double weight = scale * shape.volume;
  for (int i = 0; i < 4; ++i) {
    const Index a = group_of_[tet[i]];
    if (a == kNone) continue;
    for (int j = 0; j < 4; ++j) {
      const Index b = group_of_[tet[j]];
      if (b == kNone) continue;
      const Vec3 gi = shape.gradient.col(i), gj = shape.gradient.col(j);
      const Mat3 k = lambda * gi * gj.transpose() + mu * gj * gi.transpose() +
                     mu * gi.dot(gj) * Mat3::Identity();
      coarse_.block<6, 6>(6 * a, 6 * b) += weight * motion(tet[i]).transpose() * k * motion(tet[j]);
    }
  }
}

/// Its share of Z^T K Z, of a patch of pooled volume as it is when groups are made: what it loses
/// later only makes a preconditioner a little worse.
void RigidSpace::add_patch(Index patch) {
  const fem::Pools& pools = *problem_.pools();
  double volume = 0;
  std::map<Index, Eigen::Matrix<double, 6, 1>> of_group;
  for (Index e : pools.elements(patch)) {
    const TetShape& shape = problem_.shape(e);
    const double own = (destroyed_[e] ? share_ : 1) * shape.volume;
    volume += own;
    for (int a = 0; a < 4; ++a) {
      const Index n = problem_.mesh().tets[e][a], g = group_of_[n];
      if (g == kNone) continue;
      const auto place = of_group.try_emplace(g, Eigen::Matrix<double, 6, 1>::Zero()).first;
      place->second += own * motion(n).transpose() * shape.gradient.col(a);
    }
  }
  if (!(volume > 0)) return;
  for (const auto& [a, of_a] : of_group) {
    for (const auto& [b, of_b] : of_group) {
      coarse_.block<6, 6>(6 * a, 6 * b) += pools.bulk(patch) / volume * of_a * of_b.transpose();
    }
  }
}

void RigidSpace::add_inertia(Eigen::MatrixXd& to) const {
  for (Index n = 0; n < problem_.node_count(); ++n) {
    const Index g = group_of_[n];
    if (g == kNone) continue;
    Vec3 springs = Vec3::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_.dof(n, axis);
      if (d != kNone) springs[axis] = inertia_.of(d);
    }
    const Eigen::Matrix<double, 3, 6> m = motion(n);
    to.block<6, 6>(6 * g, 6 * g) += m.transpose() * springs.asDiagonal() * m;
  }
}

void RigidSpace::invert() {
  resting_inverse_.resize(0, 0);
  if (coarse_.rows() > 0) {
    Eigen::MatrixXd whole = coarse_;
    if (inertia_.factor > 0) add_inertia(whole);
    whole.diagonal().array() += kShift * whole.diagonal().maxCoeff();
    const Eigen::LLT<Eigen::MatrixXd> llt(whole);
    // Else blocks alone: slower, but right.
    if (llt.info() == Eigen::Success && llt.matrixLLT().allFinite()) {
      resting_inverse_ = llt.solve(Eigen::MatrixXd::Identity(whole.rows(), whole.rows()));
    }
  }
  upload_inverse(resting_inverse_);
}

void RigidSpace::upload_inverse(const Eigen::MatrixXd& inverse) {
  const Eigen::Index full = Eigen::Index{4} * solve_groups();
  Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(full, full);
  padded.topLeftCorner(inverse.rows(), inverse.cols()) = inverse;
  inverse_.write(std::span<const double>(padded.data(), static_cast<std::size_t>(padded.size())));
}

}  // namespace sunder::gpu
