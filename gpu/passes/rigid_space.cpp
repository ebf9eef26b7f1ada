// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/rigid_space.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "body/element.hpp"
#include "body/supports.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

constexpr Index kMost = shaders::kRigidGroups;
constexpr Index kNodesPerGroup = 64;  // of the largest body, until there are too many groups
constexpr Index kFewest = 4;  // nodes of a body worth a group: below, D alone is exact enough
// Added to the diagonal of Z^T K Z, in shares of its largest entry: motions that supports take away
// leave zeros there.
constexpr double kShift = 1e-13;

std::size_t coarse_size() { return std::size_t{6} * kMost; }
// Texels of four words.
constexpr std::size_t kTexel = 4 * sizeof(std::uint32_t);

}  // namespace

RigidSpace::RigidSpace(const KernelFactory& kernels, const fem::DamagedBody& body)
    : kernels_(kernels),
      body_(body),
      problem_(body.problem()),
      held_(problem_.mesh().nodes.size(), 0) {
  const Problem& problem = problem_;
  const auto gripped = problem.gripped_dofs();
  for (Index n = 0; n < problem.node_count(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index dof = problem.dof(n, axis);
      if (dof == kNone || std::binary_search(gripped.begin(), gripped.end(), dof)) {
        held_[n] |= static_cast<std::uint8_t>(1 << axis);
      }
    }
  }
  const std::size_t nodes =
      round_up(static_cast<std::uint32_t>(problem.node_count()), shaders::kGroup);
  const auto make = [&](std::size_t bytes, Placement placement) {
    Buffer buffer(kernels.device(), bytes, placement);
    buffer.fill_zero();
    return buffer;
  };
  modes_ = make(nodes * kTexel, Placement::device);
  first_ = make((kMost + 1) * sizeof(std::uint32_t), Placement::device);
  members_ = make(nodes * kTexel, Placement::device);
  inverse_ = make(coarse_size() * coarse_size() * sizeof(double), Placement::device);
  y_ = make(coarse_size() * sizeof(double), Placement::device);
  w_ = make(kMost * 8 * sizeof(double), Placement::device);
  terms_ = make(coarse_size() / 4 * sizeof(double), Placement::device);
}

std::size_t RigidSpace::planned_bytes(const Problem& problem) {
  const std::size_t nodes =
      round_up(static_cast<std::uint32_t>(problem.node_count()), shaders::kGroup);
  return 2 * nodes * kTexel + Buffer::padded((kMost + 1) * sizeof(std::uint32_t)) +
         (coarse_size() + 1) * coarse_size() * sizeof(double) + kMost * 8 * sizeof(double) +
         coarse_size() / 4 * sizeof(double);
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
  commands.barrier();
  commands.dispatch(*solve_binding_, push, solve_groups());
  commands.barrier();
}

void RigidSpace::record_indirect(vulkan::Commands& commands, const shaders::CgPush& push,
                                 const Buffer& arguments) const {
  commands.dispatch_indirect(*restrict_binding_, arguments, 3 * sizeof(std::uint32_t));
  commands.barrier();
  commands.dispatch_indirect(*solve_binding_, push, arguments, 6 * sizeof(std::uint32_t));
  commands.barrier();
}

void RigidSpace::destroy(std::span<const Index> elements) {
  for (Index e : elements) {
    if (coarse_.size() > 0) add_element(e, problem_.scene().fracture.alpha - 1);
  }
  changed_ = true;
}

void RigidSpace::update() {
  if (!changed_) return;
  changed_ = false;
  std::vector<std::vector<Index>> groups = grouped();
  if (groups != groups_) {
    groups_ = std::move(groups);
    place_modes();
    const auto size = 6 * static_cast<Index>(groups_.size());
    coarse_.setZero(size, size);
    for (Index e = 0; e < problem_.tet_count(); ++e) {
      add_element(e, body_.scale()[e]);
    }
  }
  invert();
}

/// The largest body by its extent in parts of some 64 nodes, every other body whole.
std::vector<std::vector<Index>> RigidSpace::grouped() {
  const auto bodies = fem::find_bodies(problem_.mesh(), body_.destroyed());
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
  const auto others = std::min<Index>(static_cast<Index>(nodes.size()) - 1, kMost / 2);
  const auto wanted = std::max<Index>(static_cast<Index>(nodes.front().size()) / kNodesPerGroup, 1);
  split(nodes.front(), std::min(wanted, kMost - others), groups);
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

void RigidSpace::place_modes() {
  const auto& x = problem_.mesh().nodes;
  group_of_.assign(x.size(), kNone);
  place_.assign(x.size(), Vec3::Zero());
  using Texel = std::array<std::uint32_t, 4>;
  std::vector<Texel> modes(modes_.bytes() / kTexel, Texel{0, 0, 0, shaders::kHeld});  // no group
  std::vector<Texel> members;
  std::vector<std::uint32_t> first(static_cast<std::size_t>(kMost) + 1, 0);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    Vec3 centre = Vec3::Zero();
    for (Index n : groups_[g]) centre += x[n];
    centre /= static_cast<double>(groups_[g].size());
    double size = 0;
    for (Index n : groups_[g]) size = std::max(size, (x[n] - centre).norm());
    for (Index n : groups_[g]) {
      group_of_[n] = static_cast<Index>(g);
      // What the device has, to the last bit: Z^T K Z is of the same Z.
      const Eigen::Vector3f place =
          size > 0 ? ((x[n] - centre) / size).cast<float>() : Eigen::Vector3f(0, 0, 0);
      place_[n] = place.cast<double>();
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
  const double mu = problem_.small_strain(element).mu,
               lambda = problem_.small_strain(element).lambda;
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

void RigidSpace::invert() {
  const auto full = static_cast<Index>(coarse_size());
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(full, full);
  if (const auto size = static_cast<Index>(coarse_.rows()); size > 0) {
    Eigen::MatrixXd shifted = coarse_;
    shifted.diagonal().array() += kShift * coarse_.diagonal().maxCoeff();
    const Eigen::LLT<Eigen::MatrixXd> llt(shifted);
    // Else blocks alone: slower, but right.
    if (llt.info() == Eigen::Success && llt.matrixLLT().allFinite()) {
      inverse.topLeftCorner(size, size) = llt.solve(Eigen::MatrixXd::Identity(size, size));
    }
  }
  inverse_.write(std::span<const double>(inverse.data(), static_cast<std::size_t>(inverse.size())));
}

}  // namespace sunder::gpu
