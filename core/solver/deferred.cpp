// SPDX-License-Identifier: Apache-2.0
#include "solver/deferred.hpp"

#include <algorithm>

#include "body/element.hpp"
#include "body/pools.hpp"
#include "solver/update_vectors.hpp"
#include "sunder/error.hpp"

namespace sunder::solver {

using linear_algebra::make_room;
using linear_algebra::padded;

namespace {

// Room for the differences of predicted fractures.
constexpr std::size_t kPredicted = std::size_t{1} << 14;

/// So that the system gives the memory now and no frame waits for it.
void clear_corner(linear_algebra::RowMajor& a, Eigen::Index rows, Eigen::Index columns) {
  a.topLeftCorner(std::min(rows, a.rows()), std::min(columns, a.cols())).setZero();
}

}  // namespace

Deferred::Deferred(const fem::Forms& in_base, std::unique_ptr<Base> base, bool damage,
                   Index columns)
    : problem_(in_base.problem()),
      base_(std::move(base)),
      basis_(problem_),
      unit_(static_cast<std::size_t>(problem_.dof_count()), kNone),
      is_touched_(unit_.size(), 0),
      in_base_(in_base),
      forms_(in_base) {
  const auto gripped = forms_.gripped();
  heads_ = static_cast<Eigen::Index>(gripped.size());
  if (damage) reserve_for_fractures(columns + static_cast<Index>(heads_));
  if (heads_ == 0) return;
  push_units(gripped);
  if (!replay() || !factor_grips()) {
    throw NumericalError("the compliance of the gripped nodes is singular in double precision");
  }
}

/// What events of some fifty connected elements need, so that they allocate nothing; what those of
/// sixteen need is touched. Wider rows would cost every frame.
void Deferred::reserve_for_fractures(Index columns) {
  constexpr Eigen::Index kElements = 170, kRows = 512, kColumns = 96;
  constexpr Eigen::Index kTouchedRows = 128;
  base_->make_room();
  reserve(std::min(problem_.dof_count(), kReserved) + static_cast<Index>(heads_));
  touched_.reserve(is_touched_.size());
  column_.reserve(is_touched_.size());
  rows_.reserve(static_cast<std::size_t>(12 * kElements));
  make_room(u_, kRows, kColumns);
  make_room(columns_, kRows, m_.cols());
  make_room(product_, kRows, m_.cols());
  make_room(gram_, m_.rows(), kColumns);
  make_room(xu_, m_.rows(), kColumns);
  make_room(z_, m_.rows(), kColumns);
  make_room(zt_, kColumns, m_.cols());
  make_room(at_grips_, kColumns, padded(heads_));
  clear_corner(u_, kTouchedRows, kColumns);
  for (linear_algebra::RowMajor* a : {&columns_, &product_, &zt_})
    clear_corner(*a, kTouchedRows, columns);
  for (linear_algebra::RowMajor* a : {&gram_, &xu_, &z_}) clear_corner(*a, columns, kColumns);
  for (linear_algebra::RowMajor* a : {&compliance_, &m_, &d_}) clear_corner(*a, columns, columns);
  c_.resize(kColumns, kColumns);
  event_.rows.reserve(static_cast<std::size_t>(12 * kElements));
  event_.values.reserve(static_cast<std::size_t>(6 * 12 * kElements));
  event_.ends.reserve(static_cast<std::size_t>(kElements));
  event_.w.reserve(static_cast<std::size_t>(6 * kElements * kRows));
  event_.compress.reserve(static_cast<std::size_t>(kRows));
  less_.reserve(static_cast<std::size_t>(kElements));
  before_.reserve(kReserved);
  damage_.reserve(kReserved, kReserved);
}

void Deferred::reserve(Index columns) {
  const Eigen::Index room = padded(columns) + 8;  // no power of two: rows share no cache set
  if (room <= m_.rows()) return;
  const Eigen::Index size = std::max(room, m_.rows() * 3 / 2);
  compliance_.conservativeResize(size, padded(size));
  m_.conservativeResize(size, padded(size));
  d_.conservativeResize(size, padded(size));
  filled_.reserve(size);
  under_grips_.conservativeResize(under_grips_.rows(), padded(size));
  for (Eigen::VectorXd* v : {&v_, &x_, &lack_, &gx_, &mgx_}) v->resize(size);
}

bool Deferred::factor_grips() {
  if (!border_.empty()) {
    std::vector<Eigen::Index> columns;
    for (const Held& held : held_) columns.push_back(held.column);
    border_.hold(std::move(columns));
  }
  if (grips() == 0) {
    if (grip_block_.rows() > 0) grip_block_ = Eigen::LLT<Eigen::MatrixXd>(Eigen::MatrixXd(0, 0));
    return true;
  }
  if (border_.empty()) {
    grip_block_.compute(grip_compliance_.leftCols(grips()));
  } else {
    Eigen::MatrixXd compliance = grip_compliance_.leftCols(grips());
    border_.add_to_grips(compliance);
    grip_block_.compute(compliance);
  }
  return grip_block_.info() == Eigen::Success && grip_block_.matrixLLT().allFinite();
}

/// Which unknowns are gripped now, and (A^-1)_GG by M as it is.
void Deferred::find_grips() {
  if (elsewhere_) elsewhere_->forget_forces();
  held_.clear();
  for (Index d : forms_.gripped()) held_.push_back({d, unit_[d]});
  const Eigen::Index g = grips(), n = changed_;
  grip_compliance_.setZero(g, padded(g));
  for (Eigen::Index i = 0; i < g; ++i) {
    for (Eigen::Index j = 0; j < g; ++j) {
      grip_compliance_(i, j) = compliance_(held_[static_cast<std::size_t>(i)].column,
                                           held_[static_cast<std::size_t>(j)].column);
    }
  }
  if (under_grips_.rows() != g || under_grips_.cols() != m_.cols()) {
    under_grips_.setZero(g, m_.cols());  // all of it: no later frame waits for the memory
  }
  under_grips_.leftCols(padded(count())).setZero();
  for (Eigen::VectorXd* v : {&forces_, &at_held_}) v->resize(g);
  if (g == 0 || n == 0) return;
  const Columns of = columns_of_grips();
  const Eigen::Map<const linear_algebra::RowMajor, 0, Eigen::OuterStride<>> columns(
      of.data, n, g, Eigen::OuterStride<>(of.stride));
  under_grips_.leftCols(n).noalias() = columns.transpose() * m_.topLeftCorner(n, n);
  grip_compliance_.leftCols(g).noalias() += under_grips_.leftCols(n) * columns;
}

/// Of G, those of the gripped unknowns side by side.
Deferred::Columns Deferred::columns_of_grips() {
  const Eigen::Index g = grips(), n = count();
  bool first = true;
  for (Eigen::Index i = 0; i < g; ++i) {
    first = first && held_[static_cast<std::size_t>(i)].column == static_cast<Index>(i);
  }
  if (first) return {compliance_.data(), compliance_.outerStride()};
  make_room(grip_columns_, m_.rows(), padded(g));
  for (Eigen::Index i = 0; i < n; ++i) {
    double* row = grip_columns_.row(i).data();
    for (Eigen::Index j = 0; j < g; ++j) {
      row[j] = compliance_(i, held_[static_cast<std::size_t>(j)].column);
    }
    std::fill(row + g, row + padded(g), 0.0);
  }
  return {grip_columns_.data(), grip_columns_.outerStride()};
}

/// at_grips -= G_G: x.
void Deferred::subtract_at_grips(const Eigen::VectorXd& x, Eigen::VectorXd& at_grips) const {
  for (std::size_t i = 0; i < held_.size(); ++i) {
    at_grips[static_cast<Eigen::Index>(i)] -=
        compliance_.row(held_[i].column).head(count()).dot(x.head(count()));
  }
}

Eigen::VectorXd Deferred::grip_forces() const {
  Eigen::VectorXd forces(grips());
  for (std::size_t i = 0; i < held_.size(); ++i) {
    forces[static_cast<Eigen::Index>(i)] = grip_force(i);
  }
  return forces;
}

bool Deferred::follow(const fem::Event& event) {
  if (event.of_grips()) {
    damage_.add(event);
    return follow_last();
  }
  const bool destroys = event.come.empty() && event.nodes.empty() && event.ties.empty();
  return destroys ? destroy(event.leave) : change(event);
}

bool Deferred::destroy(std::span<const Index> elements) {
  damage_.add({.leave = elements});
  return follow_last();
}

bool Deferred::follow_last() {
  const fem::Event event = damage_.last();
  forms_.add(event.nodes);
  const std::unique_ptr<fem::Forms> after = forms_after(event);
  push(event, after.get());
  if (apply(event, after.get()) && follow_border(event, count()) && factor_grips()) return true;
  take_back();
  return false;
}

void Deferred::touch(const std::array<Index, 4>& nodes) {
  for (Index n : nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      const Index d = problem_.dof(n, axis);
      if (d == kNone || is_touched_[d]) continue;
      is_touched_[d] = 1;
      touched_.push_back(d);
    }
  }
}

void Deferred::connect(const std::array<Index, 4>& nodes) {
  touch(nodes);
  basis_.add(nodes);
}

/// Brings the differences of an event to hand.
void Deferred::push(const fem::Event& event, const fem::Forms* after) {
  Before had{touched_.size(), basis_.differences().size(), units_.size(), false};
  for (Index e : event.leave) connect(glued(e));
  for (const fem::Coming& c : event.come) {
    if (c.element < forms_.element_count()) connect(glued(c.element));
    connect(forms_.parents(c.form.corners));
  }
  if (after) connect_patches(event, *after);
  const auto differences = basis_.differences().subspan(had.differences);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    column_.push_back(count_ + static_cast<Index>(i));
  }
  const Index before = count_;
  push(differences);
  push_units(event.grasp);
  had.pushed = count_ > before;
  before_.push_back(had);
}

/// A patch of pooled volume has one pressure: what changes one of its elements changes what it
/// exerts on all of their nodes.
void Deferred::connect_patches(const fem::Event& event, const fem::Forms& after) {
  find_patches(event, after);
  for (Index patch : patches_) {
    for (Index e : problem_.pools()->elements(patch)) connect(glued(e));
  }
}

/// Unit vectors of unknowns that have none yet.
void Deferred::push_units(std::span<const Index> dofs) {
  fresh_.clear();
  for (Index d : dofs) {
    if (unit_[d] != kNone) continue;
    unit_[d] = count_ + static_cast<Index>(fresh_.size());
    units_.push_back(d);
    fresh_.push_back({d, kNone});
    if (is_touched_[d]) continue;
    is_touched_[d] = 1;
    touched_.push_back(d);
  }
  push(fresh_);
}

/// New columns of B: nothing is damaged in them yet.
void Deferred::push(std::span<const Difference> vectors) {
  if (vectors.empty()) return;
  const Eigen::Index before = count_, added = static_cast<Eigen::Index>(vectors.size());
  count_ += static_cast<Index>(added);
  reserve(count_);
  make_room(gram_, m_.rows(), padded(added));
  base_->push(vectors, gram_);
  compliance_.block(0, before, count(), added) = gram_.topLeftCorner(count(), added);
  for (Eigen::Index j = 0; j < added; ++j) {
    for (Eigen::Index i = 0; i < before; ++i) compliance_(before + j, i) = gram_(i, j);
  }
  for (linear_algebra::RowMajor* a : {&m_, &d_}) {
    a->block(0, before, before, padded(count()) - before).setZero();
    a->block(before, 0, added, padded(count())).setZero();
  }
  under_grips_.middleCols(before, padded(count()) - before).setZero();
}

void Deferred::prepare(std::span<const Index> elements) {
  const std::size_t before = basis_.differences().size();
  wanted_.clear();
  wanted_.reserve(kPredicted);
  for (Index e : elements) {
    basis_.add(e);
    const Index patch = problem_.pools() ? problem_.pools()->of(e) : kNone;
    if (patch != kNone) {
      for (Index other : problem_.pools()->elements(patch)) basis_.add(other);
    }
    const auto added = basis_.differences().subspan(before);
    wanted_.insert(wanted_.end(), added.begin(), added.end());
    basis_.shrink(before);
  }
  base_->prepare(wanted_);
}

void Deferred::pop() {
  const Before before = before_.back();
  before_.pop_back();
  damage_.take_back();
  for (std::size_t i = before.touched; i < touched_.size(); ++i) is_touched_[touched_[i]] = 0;
  touched_.resize(before.touched);
  if (!before.pushed) return;
  for (std::size_t i = before.units; i < units_.size(); ++i) unit_[units_[i]] = kNone;
  count_ -= static_cast<Index>(units_.size() - before.units + basis_.differences().size() -
                               before.differences);
  units_.resize(before.units);
  column_.resize(before.differences);
  basis_.shrink(before.differences);
  base_->pop();
}

void Deferred::take_back(Index events) {
  if (this->events() < events) throw UsageError("there is no event to take back");
  if (events == 0) return;
  for (Index i = 0; i < events; ++i) pop();
  while (!sums_.empty() && sums_.back().events > this->events()) sums_.pop_back();
  if (!replay()) throw NumericalError("the stiffness of the new unknowns is singular");
  if (!factor_grips()) throw NumericalError("the compliance of the gripped nodes is singular");
}

/// No element differs from what the base has: A^-1 = X.
void Deferred::clear() {
  if (elsewhere_) elsewhere_->forget();
  changed_ = 0;
  m_.topLeftCorner(count(), padded(count())).setZero();
  d_.topLeftCorner(count(), padded(count())).setZero();
  filled_.clear();
  find_grips();
}

void Deferred::remember() {
  constexpr Index kEvents = 4;
  if (events() < (sums_.empty() ? 0 : sums_.back().events) + kEvents) return;
  const Eigen::Index n = count();
  sums_.push_back({events(), changed_, m_.topLeftCorner(n, n), d_.topLeftCorner(n, n),
                   grip_compliance_, under_grips_.leftCols(n), forms_, border_});
}

/// The last sums that are kept; returns the events in them.
std::size_t Deferred::go_to_sums() {
  forms_ = sums_.empty() ? in_base_ : sums_.back().forms;
  clear();
  border_.clear();
  if (sums_.empty()) return 0;
  const Sums& of = sums_.back();
  changed_ = of.changed;
  m_.topLeftCorner(of.m.rows(), of.m.cols()) = of.m;
  d_.topLeftCorner(of.d.rows(), of.d.cols()) = of.d;
  filled_.find(of.d, of.d.rows());
  grip_compliance_ = of.grip_compliance;
  under_grips_.resize(of.under_grips.rows(), m_.cols());
  under_grips_.leftCols(padded(count())).setZero();
  under_grips_.leftCols(of.under_grips.cols()) = of.under_grips;
  border_ = of.border;
  return static_cast<std::size_t>(of.events);
}

/// Adds all events up again, in order: the same sums as the first time.
bool Deferred::replay() {
  bool bordered = true;
  for (std::size_t i = go_to_sums(); i < damage_.size(); ++i) {
    forms_.add(damage_[i].nodes);
    const std::unique_ptr<fem::Forms> after = forms_after(damage_[i]);
    static_cast<void>(apply(damage_[i], after.get()));
    // As many columns as there were: products of another size round otherwise.
    const Eigen::Index columns =
        i + 1 < before_.size()
            ? static_cast<Eigen::Index>(before_[i + 1].differences + before_[i + 1].units)
            : count();
    bordered = bordered && follow_border(damage_[i], columns);
  }
  return bordered;
}

/// The event's update vectors: where they act in B, and U, padded to full vectors.
void Deferred::gather(std::span<const Part> parts) {
  rank_ = 6;
  if (parts.size() == 1 && parts[0].patch == kNone) {
    basis_.coordinates(parts[0].nodes, parts[0].u, rows_, u_);
  } else {
    gather_event(parts);
  }
  for (Index& row : rows_) row = column_[static_cast<std::size_t>(row)];
}

void Deferred::gather_event(std::span<const Part> all) {
  EventRoom& parts = event_;
  parts.rows.clear();
  parts.values.clear();
  parts.ends.clear();
  for (const Part& part : all) {
    basis_.coordinates(part.nodes, part.u, rows_, u_);
    parts.rows.insert(parts.rows.end(), rows_.begin(), rows_.end());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const auto row = u_.row(static_cast<Eigen::Index>(i));
      parts.values.insert(parts.values.end(), row.data(), row.data() + 6);
    }
    parts.ends.push_back(parts.rows.size());
  }
  rows_ = parts.rows;
  std::sort(rows_.begin(), rows_.end());
  rows_.erase(std::unique(rows_.begin(), rows_.end()), rows_.end());
  const auto height = static_cast<Eigen::Index>(rows_.size());
  // Six columns an element, one for what patches add up to.
  const auto begins_column = [&](std::size_t p) {
    return all[p].patch == kNone || p == 0 || all[p].patch != all[p - 1].patch;
  };
  rank_ = 0;
  for (std::size_t p = 0; p < all.size(); ++p) {
    if (begins_column(p)) rank_ += all[p].patch == kNone ? 6 : 1;
  }
  parts.w.assign(static_cast<std::size_t>(height * rank_), 0.0);
  Eigen::Map<Eigen::MatrixXd> w(parts.w.data(), height, rank_);
  Eigen::Index column = 0, width = 0;
  for (std::size_t p = 0, i = 0; p < parts.ends.size(); ++p) {
    if (begins_column(p)) column += width;
    width = all[p].patch == kNone ? 6 : 1;
    for (; i < parts.ends[p]; ++i) {
      const auto row = std::lower_bound(rows_.begin(), rows_.end(), parts.rows[i]);
      w.block(row - rows_.begin(), column, 1, width) +=
          Eigen::Map<const Eigen::Matrix<double, 1, 6>>(&parts.values[6 * i]).leftCols(width);
    }
  }
  if (rank_ > height) rank_ = compress(height, rank_, parts.w, parts.compress);
  make_room(u_, height, padded(rank_));
  u_.topLeftCorner(height, rank_) = Eigen::Map<Eigen::MatrixXd>(parts.w.data(), height, rank_);
  u_.block(0, rank_, height, padded(rank_) - rank_).setZero();
}

/// M += Z C^-1 Z^T, or -= for more stiffness; false, with M as it was, when C is not positive
/// definite.
bool Deferred::update(std::span<const Part> parts, bool more) {
  gather(parts);
  if (rows_.empty()) return true;  // every corner is held: nothing changes
  changed_ = std::max(changed_, Eigen::Index{rows_.back()} + 1);
  const Eigen::Index n = count(), width = padded(rank_), room = m_.rows();
  const auto rows = static_cast<Eigen::Index>(rows_.size());
  make_room(columns_, rows, padded(room));
  make_room(xu_, room, width);
  make_room(z_, room, width);
  make_room(zt_, width, padded(room));
  make_room(product_, width, padded(room));
  for (Eigen::Index i = 0; i < rows; ++i) {
    columns_.row(i).head(n) = compliance_.row(rows_[static_cast<std::size_t>(i)]).head(n);
  }
  // B^T X B U, from rows: X is symmetric.
  linear_algebra::row_product({columns_.data(), n, rows, 1, columns_.outerStride()}, u_.data(),
                              u_.outerStride(), width, xu_.data(), xu_.outerStride());
  linear_algebra::row_product({m_.data(), n, n, m_.outerStride(), 1}, xu_.data(), xu_.outerStride(),
                              width, z_.data(), z_.outerStride());
  for (Eigen::Index i = 0; i < rows; ++i) {
    z_.row(rows_[static_cast<std::size_t>(i)]).head(width) += u_.row(i).head(width);
  }
  if (c_.rows() < width) c_.resize(width, width);
  linear_algebra::RowMajor& product = product_;
  linear_algebra::row_product({xu_.data(), width, n, 1, xu_.outerStride()}, z_.data(),
                              z_.outerStride(), width, product.data(), product.outerStride());
  auto c = c_.topLeftCorner(width, width);
  c = product.topLeftCorner(width, width);
  if (!more) c = -c;
  c.diagonal().array() += 1;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(c);
  if (llt.info() != Eigen::Success || !c.diagonal().allFinite()) return false;
  zt_.topLeftCorner(width, padded(n)).setZero();
  zt_.topLeftCorner(width, n) = z_.topLeftCorner(n, width).transpose();
  linear_algebra::lower_solve(c_.data(), c_.outerStride(), width, zt_.data(), zt_.outerStride(),
                              padded(n), product.data());
  if (!zt_.topLeftCorner(width, n).allFinite()) return false;
  update_elsewhere(width, more);
  const linear_algebra::RowMajor* left = &zt_;
  if (more) {
    product.topLeftCorner(width, padded(n)) = -zt_.topLeftCorner(width, padded(n));
    left = &product;
  }
  linear_algebra::row_product_add({left->data(), n, width, 1, left->outerStride()}, zt_.data(),
                                  zt_.outerStride(), padded(n), m_.data(), m_.outerStride());
  if (grips() > 0) add_to_grips(width, *left);
  add_to_d(more);
  return true;
}

/// D += U U^T, or -= for more stiffness.
void Deferred::add_to_d(bool more) {
  const auto rows = static_cast<Eigen::Index>(rows_.size()), width = padded(rank_);
  make_room(zt_, width, padded(rows));
  make_room(product_, rows, padded(rows));
  zt_.topLeftCorner(width, padded(rows)).setZero();
  zt_.topLeftCorner(width, rows) = u_.topLeftCorner(rows, width).transpose();
  linear_algebra::row_product({u_.data(), rows, width, u_.outerStride(), 1}, zt_.data(),
                              zt_.outerStride(), padded(rows), product_.data(),
                              product_.outerStride());
  filled_.add(rows_);
  if (elsewhere_) elsewhere_->change_stiffness(rows_);
  for (Eigen::Index i = 0; i < rows; ++i) {
    double* row = d_.row(rows_[static_cast<std::size_t>(i)]).data();
    for (Eigen::Index j = 0; j < rows; ++j) {
      double& entry = row[rows_[static_cast<std::size_t>(j)]];
      entry += more ? -product_(i, j) : product_(i, j);
    }
  }
}

/// (A^-1)_GG and M G take the event's share of them; M has taken signed_zt^T zt_.
void Deferred::add_to_grips(Eigen::Index width, const linear_algebra::RowMajor& signed_zt) {
  const Eigen::Index g = padded(grips());
  const Columns columns = columns_of_grips();
  make_room(at_grips_, width, g);
  linear_algebra::row_product({zt_.data(), width, count(), zt_.outerStride(), 1}, columns.data,
                              columns.stride, g, at_grips_.data(), at_grips_.outerStride());
  linear_algebra::row_product_add({at_grips_.data(), grips(), width, 1, at_grips_.outerStride()},
                                  signed_zt.data(), signed_zt.outerStride(), padded(count()),
                                  under_grips_.data(), under_grips_.outerStride());
  if (&signed_zt != &zt_) {
    const auto t = at_grips_.topLeftCorner(width, grips());
    grip_compliance_.leftCols(grips()).noalias() -= t.transpose() * t;
    return;
  }
  linear_algebra::row_product_add({at_grips_.data(), grips(), width, 1, at_grips_.outerStride()},
                                  at_grips_.data(), at_grips_.outerStride(), g,
                                  grip_compliance_.data(), grip_compliance_.outerStride());
}

void Deferred::copy_damage(DamageMatrices& to) const {
  if (!border_.empty()) throw UsageError("a base cannot take new unknowns over");
  const Eigen::Index n = count();
  for (linear_algebra::RowMajor* a : {&to.compliance, &to.m, &to.d}) make_room(*a, n, n);
  to.compliance.topLeftCorner(n, n) = compliance_.topLeftCorner(n, n);
  to.m.topLeftCorner(n, n) = m_.topLeftCorner(n, n);
  to.d.topLeftCorner(n, n) = d_.topLeftCorner(n, n);
}

std::vector<BufferPlan> Deferred::buffers() const {
  std::vector<BufferPlan> plan = base_->buffers();
  const auto n = static_cast<std::size_t>(count());
  const auto grips = static_cast<std::size_t>(under_grips_.rows());
  if (n > 0) plan.push_back({"small matrix of the damage", (3 * n + grips) * n * sizeof(double)});
  if (!border_.empty()) plan.push_back({"border of the new unknowns", border_.bytes()});
  std::size_t kept = 0;
  for (const Sums& of : sums_) {
    kept += static_cast<std::size_t>(2 * of.m.size() + of.under_grips.size()) * sizeof(double) +
            of.border.bytes();
  }
  if (kept > 0) plan.push_back({"sums of events to go back to", kept});
  return plan;
}

}  // namespace sunder::solver
