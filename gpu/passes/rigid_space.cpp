// SPDX-License-Identifier: Apache-2.0
#include "gpu/passes/rigid_space.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>

#include "body/element.hpp"
#include "body/pools.hpp"
#include "gpu/passes/bisection.hpp"
#include "gpu/passes/cg_sizes.hpp"
#include "material/singular_values.hpp"

namespace sunder::gpu {
namespace {

using vulkan::Buffer;
using vulkan::Placement;

// Groups whose equations have a dense inverse; more have two levels in its place
// (rigid_levels.hpp), and groups of their own for so many pieces that have come off.
constexpr Index kMost = 64, kMostPieces = 64;
// Elements that a large body loses before its levels are made anew: so many for each of its groups.
constexpr double kLostOfAGroup = 0.25;
// Another inertia than so many times or a part of it is another body's.
constexpr double kMostInertiaApart = 4;

/// That there is room for.
Index most_groups(const Problem& problem, bool apart) {
  const Index wanted = apart ? kMost : wanted_groups(problem.node_count());
  return wanted > kMost ? wanted + kMostPieces : kMost;
}

/// Groups that vectors have room for: whole workgroups.
std::size_t room_of(Index groups) {
  return round_up(static_cast<std::uint32_t>(groups), shaders::kGroup);
}
// Terms of y^T w a group, at most.
constexpr std::size_t kTerms = 2;

// Texels of four words.
constexpr std::size_t kTexel = 4 * sizeof(std::uint32_t);

/// t x p, as a matrix times t.
Mat3 turned(const Vec3& p) {
  return (Mat3() << 0, p.z(), -p.y(), -p.z(), 0, p.x(), p.y(), -p.x(), 0).finished();
}

/// Strain (Voigt, engineering shear) by a displacement of a node whose shape function has this
/// gradient.
Eigen::Matrix<double, 6, 3> strain_of(const Vec3& g) {
  Eigen::Matrix<double, 6, 3> b;
  b << g.x(), 0, 0, 0, g.y(), 0, 0, 0, g.z(), 0, g.z(), g.y(), g.z(), 0, g.x(), g.y(), g.x(), 0;
  return b;
}

}  // namespace

RigidSpace::RigidSpace(const KernelFactory& kernels, const Problem& problem,
                       std::span<const std::uint8_t> destroyed, double share, bool apart)
    : kernels_(kernels),
      problem_(problem),
      most_(most_groups(problem, apart)),
      groups_(problem, most_, most_ > kMost ? kMostPieces : most_ / 2, apart),
      destroyed_(destroyed),
      share_(share),
      held_(problem_.mesh().nodes.size(), 0) {
  hold(problem.gripped_dofs());
  const std::size_t nodes =
      round_up(static_cast<std::uint32_t>(problem.node_count()), shaders::kGroup);
  const auto make = [&](std::size_t bytes, Placement placement) {
    Buffer buffer(kernels.device(), bytes, placement);
    buffer.fill_zero();
    return buffer;
  };
  modes_ = make(nodes * kTexel, Placement::device);
  const std::size_t room = room_of(most_);
  first_ = make((room + 1) * sizeof(std::uint32_t), Placement::device);
  members_ = make(nodes * kTexel, Placement::device);
  if (most_ > kMost) {
    levels_.emplace(kernels, most_);
  } else {
    inverse_ = make(6 * room * 6 * room * sizeof(double), Placement::device);
  }
  y_ = make(room * 6 * sizeof(double), Placement::device);
  w_ = make(room * 8 * sizeof(double), Placement::device);
  terms_ = make(room * kTerms * sizeof(double), Placement::device);
}

std::size_t RigidSpace::planned_groups(const Problem& problem) {
  return static_cast<std::size_t>(
      std::min(wanted_groups(problem.node_count()), most_groups(problem, false)));
}

std::size_t RigidSpace::planned_bytes(const Problem& problem, bool apart) {
  const Index most = most_groups(problem, apart);
  const std::size_t room = room_of(most);
  const std::size_t nodes =
      round_up(static_cast<std::uint32_t>(problem.node_count()), shaders::kGroup);
  return 2 * nodes * kTexel + Buffer::padded((room + 1) * sizeof(std::uint32_t)) +
         (most > kMost ? RigidLevels::planned_bytes(most) : 6 * room * 6 * room * sizeof(double)) +
         room * (6 + 8 + kTerms) * sizeof(double);
}

std::size_t RigidSpace::bytes() const {
  return modes_.bytes() + first_.bytes() + members_.bytes() + inverse_.bytes() + y_.bytes() +
         w_.bytes() + terms_.bytes() + (levels_ ? levels_->bytes() : 0);
}

void RigidSpace::bind(const Buffer& r) {
  const std::uint32_t group = kernels_.summing_group();
  restrict_ = kernels_.in_fp64().make("cg_restrict", group);
  const Buffer* restricted[] = {&first_, &members_, &r, &y_};
  restrict_binding_ = std::make_unique<vulkan::Binding>(kernels_.device(), *restrict_, restricted);
  if (levels_) {
    levels_->bind(y_, w_, terms_);
    return;
  }
  solve_ = kernels_.in_fp64().make("cg_coarse", group);
  const Buffer* solved[] = {&inverse_, &y_, &w_, &terms_};
  solve_binding_ = std::make_unique<vulkan::Binding>(kernels_.device(), *solve_, solved);
}

std::uint32_t RigidSpace::most_workgroups() const {
  const Index solved = levels_ ? RigidLevels::aggregates_of(most_) : kMost;
  return std::max(static_cast<std::uint32_t>(most_),
                  round_up(6 * static_cast<std::uint32_t>(solved), 16) / 4);
}

void RigidSpace::add_to(shaders::CgPush& push) const {
  push.rigid_groups = groups();
  push.rigid_solves = push.rigid_terms = solve_groups();
  if (levels_) levels_->add_to(push);
}

void RigidSpace::record(vulkan::Commands& commands, const shaders::CgPush& push) const {
  commands.dispatch(*restrict_binding_, groups());
  if (levels_) {
    levels_->record(commands, push);
  } else {
    commands.dispatch(*solve_binding_, push, solve_groups());
  }
}

void RigidSpace::record_indirect(vulkan::Commands& commands, const shaders::CgPush& push,
                                 const Buffer& arguments) const {
  commands.dispatch_indirect(*restrict_binding_, arguments, size_of_dispatch(shaders::kCgByGroup));
  if (levels_) {
    levels_->record_indirect(commands, push, arguments);
  } else {
    commands.dispatch_indirect(*solve_binding_, push, arguments,
                               size_of_dispatch(shaders::kCgBySolve));
  }
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
    if (stiffness_.rows() > 0) add_element(e, share_ - 1);
  }
  lost_ += elements.size();
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
  stiffness_ = {};
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

void RigidSpace::update(std::span<const double> u) {
  update();
  if (groups_.count() == 0 || std::ranges::equal(u, shown_)) return;
  shown_.assign(u.begin(), u.end());
  place_modes(u);
  turn(u);
}

/// The inverse by the rotations of the groups from where they rest.
void RigidSpace::turn(std::span<const double> u) {
  if (resting_inverse_.size() == 0) return;
  Eigen::MatrixXd turned = resting_inverse_;
  for (std::size_t g = 0; g < groups_.count(); ++g) {
    Vec3 mean = Vec3::Zero();
    for (Index n : groups_.nodes(g)) mean += Vec3(&u[3 * static_cast<std::size_t>(n)]);
    mean /= static_cast<double>(groups_.nodes(g).size());
    Mat3 sum = Mat3::Zero();
    for (Index n : groups_.nodes(g)) {
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
  shown_.clear();
  NodeGroups::Lists pieces = groups_.pieces(destroyed_);
  if (!stays(pieces)) {
    if (groups_.make(std::move(pieces))) {
      place_modes({});
      add_all();
    }
    build();
  }
  changed_ = false;
}

void RigidSpace::add_all() {
  const std::size_t size = groups_.count();
  stiffness_ = GroupBlocks(size, static_cast<Index>(size));
  for (Index e = 0; e < problem_.tet_count(); ++e) add_element(e, destroyed_[e] ? share_ : 1);
  for (Index p = 0; problem_.pools() && p < problem_.pools()->count(); ++p) add_patch(p);
}

/// A cut through nine tenths of a board by levels of the whole one costs 3 % more iterations.
bool RigidSpace::stays(const NodeGroups::Lists& pieces) const {
  return levels_ && groups_.count() > 0 &&
         static_cast<double>(lost_) < kLostOfAGroup * static_cast<double>(groups_.count()) &&
         groups_.are_of(pieces);
}

/// At displacement u; empty: undeformed, as Z^T K Z is taken.
void RigidSpace::place_modes(std::span<const double> u) {
  std::vector<Vec3> x = problem_.mesh().nodes;
  for (std::size_t n = 0; n < x.size() && !u.empty(); ++n) x[n] += Vec3(&u[3 * n]);
  const bool rests = u.empty();
  if (rests) {
    place_.assign(x.size(), Vec3::Zero());
    size_.assign(groups_.count(), 0.0);
    centre_.assign(groups_.count(), Vec3::Zero());
  }
  using Texel = std::array<std::uint32_t, 4>;
  std::vector<Texel> modes(modes_.bytes() / kTexel, Texel{0, 0, 0, shaders::kHeld});  // no group
  std::vector<Texel> members;
  std::vector<std::uint32_t> first(room_of(most_) + 1, 0);
  for (std::size_t g = 0; g < groups_.count(); ++g) {
    Vec3 centre = Vec3::Zero();
    for (Index n : groups_.nodes(g)) centre += x[n];
    centre /= static_cast<double>(groups_.nodes(g).size());
    if (rests) {
      centre_[g] = centre;
      for (Index n : groups_.nodes(g)) size_[g] = std::max(size_[g], (x[n] - centre).norm());
    }
    const double size = size_[g];
    for (Index n : groups_.nodes(g)) {
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
  std::fill(first.begin() + static_cast<std::ptrdiff_t>(groups_.count()) + 1, first.end(),
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
  m << Mat3::Identity(), turned(p);
  for (int axis = 0; axis < 3; ++axis) {
    if (held_[node] >> axis & 1) m.row(axis).setZero();
  }
  return m;
}

/// `scale` times the element's share of Z^T K Z: what strain the motions of its groups give it.
void RigidSpace::add_element(Index element, double scale) {
  const auto& tet = problem_.mesh().tets[element];
  const TetShape& shape = problem_.shape(element);
  std::array<Index, 4> of{};
  bool moves_whole = true;
  for (std::size_t i = 0; i < 4; ++i) {
    of[i] = groups_.of(tet[i]);
    moves_whole = moves_whole && of[i] == of[0] && held_[tet[i]] == 0;
  }
  if (moves_whole) return;
  const SmallStrain law = fem::own_law(problem_, element);
  const double weight = scale * shape.volume;
  std::array<Six, 4> strain;
  std::array<Index, 4> groups{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (of[i] == kNone) continue;
    std::size_t g = 0;
    while (g < count && groups[g] != of[i]) ++g;
    if (g == count) {
      groups[count++] = of[i];
      strain[g] = Six::Zero();
    }
    strain[g] += strain_of(shape.gradient.col(static_cast<Index>(i))) * motion(tet[i]);
  }
  for (std::size_t b = 0; b < count; ++b) {
    Six stress = 2 * law.mu * strain[b];
    stress.bottomRows<3>() /= 2;  // engineering shear
    const Eigen::Matrix<double, 1, 6> volume = strain[b].topRows<3>().colwise().sum();
    for (int axis = 0; axis < 3; ++axis) stress.row(axis) += law.lambda * volume;
    for (std::size_t a = 0; a < count; ++a) {
      stiffness_.at(groups[a], groups[b]).noalias() += weight * strain[a].transpose() * stress;
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
      const Index n = problem_.mesh().tets[e][a], g = groups_.of(n);
      if (g == kNone) continue;
      const auto place = of_group.try_emplace(g, Eigen::Matrix<double, 6, 1>::Zero()).first;
      place->second += own * motion(n).transpose() * shape.gradient.col(a);
    }
  }
  if (!(volume > 0)) return;
  for (const auto& [a, of_a] : of_group) {
    for (const auto& [b, of_b] : of_group) {
      stiffness_.at(a, b) += pools.bulk(patch) / volume * of_a * of_b.transpose();
    }
  }
}

void RigidSpace::add_inertia(Eigen::MatrixXd& to) const {
  for (Index n = 0; n < problem_.node_count(); ++n) {
    const Index g = groups_.of(n);
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

void RigidSpace::build() {
  lost_ = 0;
  if (levels_) {
    levels_->update(smoothed_levels(stiffness_, motions_of_aggregates()));
  } else {
    invert();
  }
}

void RigidSpace::invert() {
  Eigen::MatrixXd whole = stiffness_.dense();
  if (inertia_.factor > 0) add_inertia(whole);
  resting_inverse_ =
      inverse_of_positive(std::move(whole));  // none: blocks alone, slower, but right
  upload_inverse(resting_inverse_);
}

/// Every piece has its own, while there are few pieces.
GroupBlocks RigidSpace::motions_of_aggregates() const {
  const auto count = static_cast<Index>(groups_.count()), most = RigidLevels::aggregates_of(most_);
  const std::size_t pieces =
      std::min(groups_.of_pieces().size(), static_cast<std::size_t>(most) / 2);
  const Index wanted =
      std::min(RigidLevels::aggregates_of(count), most - static_cast<Index>(pieces));
  NodeGroups::Lists aggregates;
  Index first = 0;
  for (std::size_t p = 0; p < pieces; ++p) {
    std::vector<Index> list(groups_.of_pieces()[p]);
    std::iota(list.begin(), list.end(), first);
    first += static_cast<Index>(list.size());
    bisect(list, share_of(wanted, list.size(), groups_.count()), 1, centre_, aggregates);
  }
  GroupBlocks motions(groups_.count(), static_cast<Index>(aggregates.size()));
  for (std::size_t a = 0; a < aggregates.size(); ++a) {
    Vec3 centre = Vec3::Zero();
    for (Index g : aggregates[a]) centre += centre_[g] / static_cast<double>(aggregates[a].size());
    double size = 0;
    for (Index g : aggregates[a]) size = std::max(size, (centre_[g] - centre).norm() + size_[g]);
    for (Index g : aggregates[a]) {
      Six& of = motions.at(g, static_cast<Index>(a));
      of.setIdentity();
      if (!(size > 0)) continue;
      of.topRightCorner<3, 3>() = turned((centre_[g] - centre) / size);
      of.bottomRightCorner<3, 3>() *= size_[g] / size;
    }
  }
  return motions;
}

void RigidSpace::upload_inverse(const Eigen::MatrixXd& inverse) {
  const Eigen::Index full = Eigen::Index{4} * solve_groups();
  Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(full, full);
  padded.topLeftCorner(inverse.rows(), inverse.cols()) = inverse;
  inverse_.write(std::span<const double>(padded.data(), static_cast<std::size_t>(padded.size())));
}

}  // namespace sunder::gpu
