// SPDX-License-Identifier: Apache-2.0
#include "solver/finite_base.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "body/deformation.hpp"
#include "material/linear.hpp"
#include "material/singular_values.hpp"

namespace sunder::solver {
namespace {

// Columns that go through the factor together.
constexpr Index kColumnGroup = 32;
// Of S, squared diagonal of its factor: what is left holds by rounding alone.
constexpr double kLeastLeft = 1e-10;
// Under this angle [rad] turning wins nothing. A hundredth is too much where parts are stiff: on
// the board with its frame a frame took 5 instead of 3 back-solves.
constexpr double kLeastTurn = 1e-4;

std::uint64_t next_stamp() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

bool same_patches(const std::shared_ptr<const fem::Pools>& one,
                  const std::shared_ptr<const fem::Pools>& other) {
  return one == other || (one && other && *one == *other);
}

Index full_vectors(Index columns) { return (columns + 7) / 8 * 8; }

}  // namespace

FiniteBase::FiniteBase(const fem::HyperelasticBody& body, std::vector<double> u, fem::Tangent kind,
                       const fem::TangentPattern& pattern, const fem::Inertia& inertia,
                       const linear_algebra::FactorWork& work)
    : problem_(&body.problem),
      border_(body.problem),
      laws_(body.law_of_volume.begin(), body.law_of_volume.end()),
      out_(problem_->mesh().tets.size(), 0),
      u_(std::move(u)),
      kind_(kind),
      pools_(body.split),
      patches_(body, u_),
      inertia_(inertia.factor),
      factor_(pattern.supernodes(), pattern.tangent(body, u_, kind, inertia), work),
      columns_(factor_.cholesky().supernodes()),
      column_(static_cast<std::size_t>(problem_->dof_count()), kNone),
      coupled_(column_.size(), 0),
      stamps_{next_stamp(), next_stamp(), next_stamp()} {
  std::ranges::copy(body.destroyed, out_.begin());
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    if (out_[e]) continue;
    for (Index n : problem_->mesh().tets[e]) {
      for (int axis = 0; axis < 3; ++axis) {
        if (problem_->dof(n, axis) != kNone) coupled_[problem_->dof(n, axis)] = 1;
      }
    }
  }
  for (Index d : problem_->gripped_dofs()) coupled_[d] = 0;
}

void FiniteBase::keep_inverse(const linear_algebra::FactorWork& work) {
  inverse_ = factor_.inverse(work);
  stamps_.inverse = next_stamp();
}

bool FiniteBase::follow(const RestingBody& now, Index most_rank) {
  std::vector<Index> lost, fresh;
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    if (now.out()[e] == out_[e]) continue;
    if (!now.out()[e]) return false;
    lost.push_back(e);
    for (Index n : border_.corners(e)) touch_node(n, fresh);
  }
  if (!same_patches(now.body().split, pools_)) return false;  // a piece has come off
  pools_ = now.body().split;
  touch_patches(lost, fresh);
  for (Index d = 0; gripped_ && d < static_cast<Index>(held_.size()); ++d) {
    if (!held_[d] || column_[d] != kNone) continue;
    column_[d] = static_cast<Index>(touched_.size() + fresh.size());
    fresh.push_back(d);
  }
  if (lost.empty() && !parted_ && !gripped_) return true;
  const std::size_t rank =
      touched_.size() + fresh.size() + static_cast<std::size_t>(border_.size());
  if (rank > static_cast<std::size_t>(most_rank)) return false;
  touch(fresh);
  for (const PatchVector& k : before_) add_pressure(k, 1);
  for (Index e : lost) lose(e);
  for (Index patch : changed_) add_pressure(patch_vector(patch), -1);
  const bool less = !lost.empty() || !before_.empty();
  before_.clear();
  if ((less || gripped_) && !correct(now)) return false;
  gripped_ = false;
  return border_.empty() || follow_border();
}

/// Its unknowns get columns.
void FiniteBase::touch_node(Index node, std::vector<Index>& fresh) {
  for (int axis = 0; axis < 3; ++axis) {
    const Index d = problem_->dof(node, axis);
    if (d == kNone || !coupled_[d] || column_[d] != kNone) continue;
    column_[d] = static_cast<Index>(touched_.size() + fresh.size());
    fresh.push_back(d);
  }
}

bool FiniteBase::part(const Problem& now, const fem::Parting& parting,
                      std::span<const double> mass) {
  if (std::ranges::find(held_, std::uint8_t{1}) != held_.end()) return false;
  if (pools_) return false;  // pieces have patches of their own
  if (problem_->pools()) part_patches(now);
  problem_ = &now;
  parting.nodal(u_);
  border_.part(now, mass);
  parted_ = true;
  coupled_.resize(static_cast<std::size_t>(now.dof_count()), 1);
  for (Index d : now.gripped_dofs()) coupled_[d] = 0;
  return true;
}

bool FiniteBase::grip(const Problem& now) {
  if (!border_.empty() || parted_) return false;
  std::vector<std::uint8_t> gripped(coupled_.size(), 0), held(coupled_.size(), 0);
  for (Index d : now.gripped_dofs()) gripped[d] = 1;
  for (Index d : problem_->gripped_dofs()) {
    if (!gripped[d] && !coupled_[d]) return false;
  }
  for (Index d : now.gripped_dofs()) held[d] = coupled_[d];
  problem_ = &now;
  border_.see(now);
  held_ = std::move(held);
  gripped_ = true;
  return true;
}

bool FiniteBase::follow_border() {
  parted_ = false;
  const auto tangent = [this](Index e) {
    return fem::element_tangent({*problem_, laws_}, e, u_, kind_, patches_.pressure());
  };
  return border_.follow(
      {tangent, [this](Index patch) { return patch_tangent(patch); },
       [this](Eigen::MatrixXd& of) { solve_columns(of); }, out_, coupled_, inertia_},
      m_, touched_);
}

/// By A alone, nothing lost and nothing turned.
void FiniteBase::solve_columns(Eigen::MatrixXd& of) {
  if (inverse_.size() > 0) {
    of = inverse_ * of;
    return;
  }
  const linear_algebra::SupernodalCholesky& l = factor_.cholesky();
  const auto& place = l.supernodes().place;
  std::vector<Index> all(static_cast<std::size_t>(l.supernodes().count()));
  std::iota(all.begin(), all.end(), 0);
  l.make_room(kColumnGroup, work_);
  for (Eigen::Index first = 0; first < of.cols(); first += kColumnGroup) {
    const Eigen::Index count = std::min<Eigen::Index>(kColumnGroup, of.cols() - first);
    linear_algebra::RowMajor y =
        linear_algebra::RowMajor::Zero(of.rows(), full_vectors(static_cast<Index>(count)));
    for (std::size_t i = 0; i < place.size(); ++i) {
      y.row(place[i]).head(count) = of.row(static_cast<Eigen::Index>(i)).segment(first, count);
    }
    l.forward(all, y, work_);
    l.backward(y, work_);
    for (std::size_t i = 0; i < place.size(); ++i) {
      of.row(static_cast<Eigen::Index>(i)).segment(first, count) = y.row(place[i]).head(count);
    }
  }
}

/// Appends columns of L^-1 E_T, and of G.
void FiniteBase::touch(std::span<const Index> unknowns) {
  const auto before = static_cast<Index>(touched_.size()),
             after = before + static_cast<Index>(unknowns.size());
  g_.conservativeResize(after, after);
  d_.conservativeResize(after, after);
  d_.rightCols(after - before).setZero();
  d_.bottomRows(after - before).setZero();
  if (rows_.rows() == 0) {
    rows_.setZero(factor_.cholesky().size(), kColumnGroup);
    factor_.cholesky().make_room(kColumnGroup, work_);
    columns_.make_room();
  }
  for (std::size_t begin = 0; begin < unknowns.size(); begin += kColumnGroup) {
    push_group(
        unknowns.subspan(begin, std::min<std::size_t>(kColumnGroup, unknowns.size() - begin)));
  }
}

void FiniteBase::push_group(std::span<const Index> unknowns) {
  const linear_algebra::SupernodalCholesky& l = factor_.cholesky();
  const auto& nodes = l.supernodes();
  const auto count = static_cast<Index>(unknowns.size()), first = touched_count();
  places_.clear();
  for (Index i = 0; i < count; ++i) {
    places_.push_back(nodes.place[unknowns[i]]);
    rows_(places_.back(), i) = 1;
  }
  l.reach(places_, path_, work_);
  l.forward(path_, rows_.leftCols(full_vectors(count)), work_);
  columns_.append(path_, rows_, count);
  touched_.insert(touched_.end(), unknowns.begin(), unknowns.end());
  block_.resize(columns_.size(), kColumnGroup);
  columns_.multiply(path_, rows_, full_vectors(count), block_);
  g_.block(0, first, touched_count(), count) = block_.topLeftCorner(touched_count(), count);
  g_.block(first, 0, count, touched_count()) =
      block_.topLeftCorner(touched_count(), count).transpose();
  for (Index s : path_) rows_.middleRows(nodes.first[s], nodes.width(s)).setZero();
}

/// Adds an element's tangent to D.
void FiniteBase::lose(Index element) {
  const fem::ElementMatrix k =
      fem::element_tangent({*problem_, laws_, {}, pools_}, element, u_, kind_, patches_.pressure());
  std::array<Index, 12> at;
  for (int i = 0; i < 12; ++i) {
    const Index d = problem_->dof(border_.corners(element)[i / 3], i % 3);
    at[i] = d == kNone ? kNone : column_[d];
  }
  for (int j = 0; j < 12; ++j) {
    for (int i = 0; i < 12; ++i) {
      if (at[i] != kNone && at[j] != kNone) d_(at[i], at[j]) += k(i, j);
    }
  }
  out_[element] = 1;
}

/// With the elements that it has now, at the base's state.
fem::PatchTangent FiniteBase::patch_tangent(Index patch) const {
  return fem::patch_tangent({*problem_, laws_, out_, pools_}, patch, u_,
                            patches_.stiffness()[patch], kind_);
}

FiniteBase::PatchVector FiniteBase::patch_vector(Index patch) const {
  PatchVector of{patch_tangent(patch), {}};
  if (of.tangent.b.size() == 0) return of;
  for (Index n : pools()->nodes(*problem_, patch)) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_->dof(n, axis);
      of.unknowns.push_back(d == kNone ? kNone : border_.glued(d));
    }
  }
  return of;
}

/// Patches are about to be those of a body that has parted further: what those that a crack splits
/// were stiff by goes, and each part has the pressure and U'' of the whole.
void FiniteBase::part_patches(const Problem& now) {
  const fem::Pools &was = *problem_->pools(), &is = *now.pools();
  for (Index patch = 0; patch < was.count(); ++patch) {
    const auto elements = was.elements(patch);
    if (std::ranges::equal(elements, is.elements(is.of(elements.front())))) continue;
    if (!split_.contains(elements.front())) before_.push_back(patch_vector(patch));
    split_.insert(elements.begin(), elements.end());
  }
  patches_.part(was, is);
}

/// Patches of what is lost, and those that a crack has split since: all of their nodes get columns.
void FiniteBase::touch_patches(std::span<const Index> lost, std::vector<Index>& fresh) {
  changed_.clear();
  const fem::Pools* pools = this->pools();
  if (!pools) return;
  pools->of(lost, changed_);
  // One that was split has its old vector there already.
  for (Index patch : changed_) {
    const auto of_split = [&](Index e) { return split_.contains(e); };
    if (std::ranges::none_of(pools->elements(patch), of_split)) {
      before_.push_back(patch_vector(patch));
    }
  }
  std::vector<Index> split;
  pools->of(std::vector<Index>(split_.begin(), split_.end()), split);
  for (Index patch : split) {
    if (std::ranges::find(changed_, patch) == changed_.end()) changed_.push_back(patch);
  }
  split_.clear();
  for (Index patch : changed_) {
    for (Index e : pools->elements(patch)) {
      if (out_[e]) continue;
      for (Index n : border_.corners(e)) touch_node(n, fresh);
    }
  }
}

/// Adds to D what a patch is stiff by.
void FiniteBase::add_pressure(const PatchVector& patch, double times) {
  const Eigen::VectorXd& b = patch.tangent.b;
  const auto column = [&](std::size_t i) {
    const Index d = patch.unknowns[i];
    return d == kNone ? kNone : column_[static_cast<std::size_t>(d)];
  };
  for (std::size_t j = 0; j < patch.unknowns.size(); ++j) {
    for (std::size_t i = 0; i < patch.unknowns.size(); ++i) {
      const Index row = column(i), col = column(j);
      if (row == kNone || col == kNone) continue;
      d_(row, col) += times * patch.tangent.factor * b[static_cast<Eigen::Index>(i)] *
                      b[static_cast<Eigen::Index>(j)];
    }
  }
}

/// M of the head comment, unknowns that are held still first.
bool FiniteBase::correct(const RestingBody& now) {
  std::vector<Index> in_order, moving;
  for (Index i = 0; i < touched_count(); ++i) {
    const Index d = touched_[static_cast<std::size_t>(i)];
    const bool still = now.frozen()[d] || (!held_.empty() && held_[d]);
    (still ? in_order : moving).push_back(i);
  }
  const auto held = static_cast<Eigen::Index>(in_order.size()),
             free = static_cast<Eigen::Index>(moving.size());
  in_order.insert(in_order.end(), moving.begin(), moving.end());
  const Eigen::LLT<Eigen::MatrixXd> g(g_(in_order, in_order));
  if (g.info() != Eigen::Success) return false;
  const Eigen::MatrixXd root = g.matrixL();
  const Eigen::MatrixXd r = root.bottomRightCorner(free, free);
  const Eigen::MatrixXd d = d_(moving, moving);
  Eigen::MatrixXd rd = r.triangularView<Eigen::Lower>().transpose() * d;
  Eigen::MatrixXd s = -rd * r.triangularView<Eigen::Lower>();
  s.diagonal().array() += 1;
  const Eigen::LLT<Eigen::MatrixXd> left(s);
  if (free > 0 && (left.info() != Eigen::Success ||
                   !(left.matrixLLT().diagonal().minCoeff() > std::sqrt(kLeastLeft)))) {
    return false;
  }
  left.matrixL().solveInPlace(rd);
  Eigen::MatrixXd of_moving = d;
  of_moving.noalias() += rd.transpose() * rd;
  // c = G_ZZ^-1 G_ZF.
  const auto corner = root.topLeftCorner(held, held).triangularView<Eigen::Lower>();
  Eigen::MatrixXd c = root.bottomLeftCorner(free, held).transpose();
  corner.transpose().solveInPlace(c);
  Eigen::MatrixXd whole(touched_count(), touched_count());
  whole.bottomRightCorner(free, free) = of_moving;
  const Eigen::MatrixXd between = -c * of_moving;
  whole.topRightCorner(held, free) = between;
  whole.bottomLeftCorner(free, held) = between.transpose();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(held, held);
  corner.solveInPlace(inverse);
  whole.topLeftCorner(held, held) = -(inverse.transpose() * inverse) - between * c.transpose();
  m_.resize(touched_count(), touched_count());
  m_(in_order, in_order) = whole;
  stamps_.small = next_stamp();
  return true;
}

void FiniteBase::turn(const RestingBody& now, std::span<const double> u) {
  turned_.clear();
  largest_turn_ = 0;
  const Mesh& mesh = problem_->mesh();
  std::vector<Mat3> sum(mesh.nodes.size(), Mat3::Zero());
  for (Index e = 0; e < problem_->tet_count(); ++e) {
    if (now.out()[e]) continue;
    const double volume = problem_->shape(e).volume;
    const Mat3 from = Mat3::Identity() + fem::displacement_gradient(*problem_, e, u_),
               to = Mat3::Identity() + fem::displacement_gradient(*problem_, e, u);
    // The linear law's stiffness does not turn.
    const bool turns = laws_[problem_->mesh().volume_of[e]] != &kLinear;
    const Mat3 both = volume * (turns ? Mat3(to * from.transpose()) : Mat3::Identity());
    for (Index n : mesh.tets[e]) sum[n] += both;
  }
  for (Index n = 0; n < mesh.node_count(); ++n) {
    std::array<Index, 3> at;
    bool free = true;
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = problem_->dof(n, axis);
      free = free && at[axis] != kNone && coupled_[at[axis]] && !now.frozen()[at[axis]] &&
             (held_.empty() || !held_[at[axis]]);
    }
    if (!free || sum[n].isZero()) continue;  // none left around it: nothing to turn
    const Mat3 q = nearest_rotation(sum[n]);
    largest_turn_ = std::max(largest_turn_, std::acos(std::clamp((q.trace() - 1) / 2, -1.0, 1.0)));
    turned_.push_back({at, q});
  }
  if (largest_turn_ < kLeastTurn) turned_.clear();
  stamps_.turned = next_stamp();
}

void FiniteBase::rotate(const Eigen::VectorXd& from, bool back, Eigen::VectorXd& to) const {
  to = from;
  for (const Turned& t : turned_) {
    const Vec3 v(from[t.unknowns[0]], from[t.unknowns[1]], from[t.unknowns[2]]);
    const Vec3 w = back ? Vec3(t.q.transpose() * v) : Vec3(t.q * v);
    for (int axis = 0; axis < 3; ++axis) to[t.unknowns[axis]] = w[axis];
  }
}

void FiniteBase::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) {
  const Eigen::VectorXd* of = &b;
  if (!turned_.empty()) {
    rotate(b, true, back_);
    of = &back_;
  }
  if (border_.empty()) {
    inverse_.size() > 0 ? solve_by_inverse(*of, x) : solve_by_factor(*of, x);
  } else {
    border_.gather(*of, on_base_);
    inverse_.size() > 0 ? solve_by_inverse(on_base_, x, of) : solve_by_factor(on_base_, x, of);
    border_.add(offsets_, x);
  }
  if (!turned_.empty()) {
    back_ = x;
    rotate(back_, false, x);
  }
}

void FiniteBase::solve_ordered(const linear_algebra::Supernodes& order,
                               linear_algebra::RowMajor& b) {
  if (&order != &factor_.cholesky().supernodes()) {  // it is of a body that has parted since
    Eigen::VectorXd f(b.rows()), x;
    for (Eigen::Index column = 0; column < b.cols(); ++column) {
      for (std::size_t i = 0; i < order.place.size(); ++i) {
        f[static_cast<Eigen::Index>(i)] = b(order.place[i], column);
      }
      solve(f, x);
      for (std::size_t i = 0; i < order.place.size(); ++i) {
        b(order.place[i], column) = x[static_cast<Eigen::Index>(i)];
      }
    }
    return;
  }
  for (Eigen::Index column = 0; column < b.cols(); column += kColumnGroup) {
    solve_group(b.middleCols(column, std::min<Eigen::Index>(kColumnGroup, b.cols() - column)));
  }
}

/// By the factor, which reads a panel once for all of them.
void FiniteBase::solve_group(Eigen::Ref<linear_algebra::RowMajor> b) {
  const linear_algebra::SupernodalCholesky& l = factor_.cholesky();
  const auto& nodes = l.supernodes();
  linear_algebra::RowMajor y =
      linear_algebra::RowMajor::Zero(b.rows(), full_vectors(static_cast<Index>(b.cols())));
  y.leftCols(b.cols()) = b;
  const auto turn = [&](bool back) {
    for (const Turned& t : turned_) {
      Eigen::Matrix<double, 3, Eigen::Dynamic> rows(3, b.cols());
      for (int axis = 0; axis < 3; ++axis) {
        rows.row(axis) = y.row(nodes.place[t.unknowns[axis]]).head(b.cols());
      }
      rows = (back ? Mat3(t.q.transpose()) : t.q) * rows;
      for (int axis = 0; axis < 3; ++axis) {
        y.row(nodes.place[t.unknowns[axis]]).head(b.cols()) = rows.row(axis);
      }
    }
  };
  turn(true);
  std::vector<Index> all(static_cast<std::size_t>(nodes.count()));
  std::iota(all.begin(), all.end(), 0);
  l.make_room(kColumnGroup, work_);
  l.forward(all, y, work_);
  if (touched_count() > 0) {
    columns_.make_room();
    linear_algebra::RowMajor with(touched_count(), y.cols());
    columns_.multiply(all, y, static_cast<Index>(y.cols()), with);
    for (Eigen::Index column = 0; column < b.cols(); ++column) {
      c_.noalias() = m_ * with.col(column);
      y_ = y.col(column);
      columns_.add(c_, y_);
      y.col(column) = y_;
    }
  }
  l.backward(y, work_);
  turn(false);
  b = y.leftCols(b.cols());
}

/// `forces`: where there are offsets, on all unknowns; b has those on the base's.
void FiniteBase::solve_by_factor(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                                 const Eigen::VectorXd* forces) {
  const linear_algebra::SupernodalCholesky& l = factor_.cholesky();
  const auto& place = l.supernodes().place;
  y_.resize(b.size());
  for (std::size_t i = 0; i < place.size(); ++i) y_[place[i]] = b[static_cast<Eigen::Index>(i)];
  l.forward(y_, work_);
  if (touched_count() > 0) columns_.project(y_, 0, p_);
  p_.conservativeResize(touched_count());
  if (forces) border_.solve(*forces, b, m_, p_, offsets_);
  if (touched_count() > 0) {
    c_.noalias() = m_ * p_;
    columns_.add(c_, y_);
  }
  l.backward(y_, work_);
  x.resize(b.size());
  for (std::size_t i = 0; i < place.size(); ++i) x[static_cast<Eigen::Index>(i)] = y_[place[i]];
}

void FiniteBase::solve_by_inverse(const Eigen::VectorXd& b, Eigen::VectorXd& x,
                                  const Eigen::VectorXd* forces) {
  x.noalias() = inverse_ * b;
  p_ = x(touched_);
  if (forces) border_.solve(*forces, b, m_, p_, offsets_);
  if (touched_count() == 0) return;
  c_.noalias() = m_ * p_;
  for (Index i = 0; i < touched_count(); ++i) x += c_[i] * inverse_.col(touched_[i]);
}

}  // namespace sunder::solver
