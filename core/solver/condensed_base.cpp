// SPDX-License-Identifier: Apache-2.0
#include "solver/condensed_base.hpp"

#include <algorithm>

#include "solver/columns.hpp"

namespace sunder::solver {

namespace {

constexpr std::size_t kVectors = 1024;  // room for them

}  // namespace

void Equilibrium::reserve(std::size_t loaded, std::size_t touched) {
  dofs.reserve(loaded + touched);
  forces.reserve(loaded + touched);
  lost_u.reserve(touched);
}

std::size_t Equilibrium::bytes() const {
  return dofs.capacity() * sizeof(Index) + (forces.capacity() + lost_u.capacity()) * sizeof(double);
}

void CondensedState::reserve(std::size_t unknowns, std::size_t differences) {
  dofs.reserve(unknowns);
  vectors.reserve(differences);
}

void CondensedState::settle() {
  const bool same = x.same_as(x_of_factor);
  x = GrownInverse(x.whole());
  x_of_factor = same ? x : GrownInverse(x_of_factor.whole());
}

void CondensedState::release() {
  factor.reset();
  x = {};
  x_of_factor = {};
  lost.reset();
}

CondensedBase::CondensedBase(std::shared_ptr<const linear_algebra::Factor> factor,
                             std::span<const Index> dofs, const linear_algebra::FactorWork& work)
    : CondensedBase(
          factor, dofs,
          std::make_shared<const Eigen::MatrixXd>(factor->inverse_block(dofs, dofs, work))) {}

CondensedBase::CondensedBase(const CondensedState& before, Eigen::MatrixXd x,
                             std::shared_ptr<const LostStiffness> lost)
    : CondensedBase(before.factor, before.dofs,
                    std::make_shared<const Eigen::MatrixXd>(std::move(x))) {
  x_of_factor_ = before.x_of_factor;
  lost_ = std::move(lost);
}

CondensedBase::CondensedBase(std::shared_ptr<const linear_algebra::Factor> factor,
                             std::span<const Index> dofs, std::shared_ptr<const Eigen::MatrixXd> x)
    : factor_(std::move(factor)),
      dofs_(dofs.begin(), dofs.end()),
      place_(static_cast<std::size_t>(factor_->cholesky().size()), kNone),
      x_(std::move(x)),
      x_of_factor_(x_) {
  for (std::size_t i = 0; i < dofs_.size(); ++i) place_[dofs_[i]] = static_cast<Index>(i);
  is_touched_.assign(dofs_.size(), kNone);
  u_.setZero(x_.size());
  lacks_ = all_forces_ = mended_ = u_;
  starts_.reserve(dofs_.size());
  projected_.resize(kVectors);
  touched_.reserve(dofs_.size());
  loaded_.reserve(dofs_.size());
  forces_.reserve(dofs_.size());
  loads_.reserve(dofs_.size());
  vectors_.reserve(kVectors);
  pushes_.reserve(kVectors);
  there_.reserve(dofs_.size());
  forces_there_.reserve(dofs_.size());
  make_room_everywhere();
}

/// So that a load outside S, which is that of a full check, allocates nothing.
void CondensedBase::make_room_everywhere() {
  const auto all = static_cast<std::size_t>(size());
  for (Loaded* loaded : {&loads_of_some_, &loads_of_all_}) {
    loaded->load.reserve(all);
    loaded->u.setZero(x_.size());
    loaded->by_factor.setZero(x_.size());
  }
  right_side_.setZero(size());
  solution_.setZero(size());
  work_.below.reserve(all);
  work_.permuted.setZero(size());
  moved_.reserve(dofs_.size());
  of_moved_.reserve(dofs_.size());
}

void CondensedBase::forget_loads() {
  loads_of_some_.load.forget();
  loads_of_all_.load.forget();
}

void CondensedBase::grow(std::span<const Difference> vectors) {
  const std::size_t before = dofs_.size();
  for (const Difference& v : vectors) {
    for (Index d : {v.dof, v.other}) {
      if (d == kNone || place_[d] != kNone) continue;
      place_[d] = static_cast<Index>(dofs_.size());
      dofs_.push_back(d);
    }
  }
  if (dofs_.size() == before) return;
  const auto added = std::span(dofs_).subspan(before);
  Eigen::MatrixXd columns;
  if (!growth_ || !growth_->take(*factor_, dofs_, added, columns)) {
    columns = factor_->inverse_block(dofs_, added, {.threads = growing_threads_});
  }
  x_of_factor_.add(columns);
  if (lost_) {
    add_lost_to(columns);
    x_.add(columns);
  } else {
    x_ = x_of_factor_;
  }
  is_touched_.resize(dofs_.size(), kNone);
  forget_loads();
  u_.setZero(x_.size());
}

/// Columns of X0 for further unknowns, over all of S, become those of X: with D what was lost, X =
/// X0 + X0 D X0 + X0 D X D X0, and X D X0 of it on the old unknowns.
void CondensedBase::add_lost_to(Eigen::MatrixXd& columns) {
  const Eigen::Index old = x_.size(), k = columns.cols();
  const auto dofs = lost_->dofs();
  std::vector<Index> places;
  for (Index d : dofs) places.push_back(place_[d]);
  Eigen::MatrixXd forces(static_cast<Eigen::Index>(dofs.size()), k);
  std::vector<double> moved(dofs.size());
  for (Eigen::Index j = 0; j < k; ++j) {
    lose(columns.col(j).data(), moved, {forces.col(j).data(), dofs.size()});
  }
  for (Eigen::Index j = 0; j < k; ++j) {
    add(x_, places, {forces.col(j).data(), dofs.size()}, columns.col(j).data());
  }
  for (Eigen::Index j = 0; j < k; ++j) {
    for (Eigen::Index i = 0; i < k; ++i) {
      for (std::size_t l = 0; l < places.size(); ++l) {
        columns(old + i, j) += forces(static_cast<Eigen::Index>(l), i) * columns(places[l], j);
      }
    }
  }
}

/// y += the columns of x at some places times values.
void CondensedBase::add(const GrownInverse& x, std::span<const Index> places,
                        std::span<const double> values, double* y) {
  starts_.clear();
  for (Index p : places) starts_.push_back(x.column(p).first);
  add_columns(starts_, values, x.first_rows(), y);
  if (x.added() == 0) return;
  starts_.clear();
  for (Index p : places) starts_.push_back(x.column(p).added);
  add_columns(starts_, values, x.added(), y + x.first_rows());
}

/// S is the first so many of its unknowns again.
void CondensedBase::shrink(std::size_t size) {
  if (dofs_.size() == size) return;
  for (Index d : std::span(dofs_).subspan(size)) place_[d] = kNone;
  dofs_.resize(size);
  if (product_) product_->forget(static_cast<Index>(size));
  const Eigen::Index added = static_cast<Eigen::Index>(size) - x_.first_rows();
  x_.keep_added(added);
  x_of_factor_.keep_added(added);
  is_touched_.resize(size);
  forget_loads();
  u_.setZero(x_.size());
}

void CondensedBase::push(std::span<const Difference> vectors, linear_algebra::RowMajor& gram) {
  const std::size_t unknowns = dofs_.size();
  grow(vectors);
  pushes_.push_back({vectors_.size(), unknowns});
  vectors_.insert(vectors_.end(), vectors.begin(), vectors.end());
  for (const Difference& v : vectors) {
    for (Index d : {v.dof, v.other}) {
      if (d == kNone || is_touched_[place_[d]] != kNone) continue;
      is_touched_[place_[d]] = static_cast<Index>(touched_.size());
      touched_.push_back(place_[d]);
    }
  }
  for (std::size_t j = 0; j < vectors.size(); ++j) {
    const bool two = vectors[j].other != kNone;
    const GrownInverse::Column a = x_.column(place_[vectors[j].dof]),
                               b = two ? x_.column(place_[vectors[j].other]) : a;
    for (std::size_t i = 0; i < vectors_.size(); ++i) {
      const Index dof = place_[vectors_[i].dof];
      double value = two ? a[dof] - b[dof] : a[dof];
      if (vectors_[i].other != kNone) {
        const Index other = place_[vectors_[i].other];
        value -= two ? a[other] - b[other] : a[other];
      }
      gram(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = value;
    }
  }
}

void CondensedBase::pop() {
  const Before before = pushes_.back();
  vectors_.resize(before.vectors);
  pushes_.pop_back();
  for (Index p : touched_) is_touched_[p] = kNone;
  touched_.clear();
  shrink(before.unknowns);
  for (const Difference& v : vectors_) {
    for (Index d : {v.dof, v.other}) {
      if (d == kNone || is_touched_[place_[d]] != kNone) continue;
      is_touched_[place_[d]] = static_cast<Index>(touched_.size());
      touched_.push_back(place_[d]);
    }
  }
}

void CondensedBase::apply_inside(std::span<const Index> dofs, std::span<const double> values) {
  loaded_.clear();
  for (Index d : dofs) loaded_.push_back(place_[d]);
  last_->u.setZero(x_.size());
  add(x_, loaded_, values, last_->u.data());
}

/// D u of one column u on S, on the unknowns of D; `moved` is u there.
void CondensedBase::lose(const double* u, std::span<double> moved, std::span<double> forces) const {
  const auto dofs = lost_->dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) moved[i] = u[place_[dofs[i]]];
  lost_->multiply(moved, forces);
}

/// D u of u on S, as forces on S: all_forces_.
void CondensedBase::find_lost_forces(const Eigen::VectorXd& u) {
  const auto dofs = lost_->dofs();
  moved_.resize(dofs.size());
  of_moved_.resize(dofs.size());
  lose(u.data(), moved_, of_moved_);
  all_forces_.setZero(u.size());
  for (std::size_t i = 0; i < dofs.size(); ++i) all_forces_[place_[dofs[i]]] = of_moved_[i];
}

/// u of the last load += X D u.
void CondensedBase::add_lost() {
  const auto dofs = lost_->dofs();
  moved_.resize(dofs.size());
  of_moved_.resize(dofs.size());
  lose(last_->u.data(), moved_, of_moved_);
  loaded_.clear();
  for (Index d : dofs) loaded_.push_back(place_[d]);
  add(x_, loaded_, of_moved_, last_->u.data());
}

/// With g = X0 f, X f = g + X D g.
void CondensedBase::apply_everywhere(std::span<const Index> dofs, std::span<const double> values) {
  right_side_.setZero(size());
  for (std::size_t i = 0; i < dofs.size(); ++i) right_side_[dofs[i]] += values[i];
  factor_->solve(right_side_, solution_, work_);
  last_->u.resize(x_.size());
  for (std::size_t i = 0; i < dofs_.size(); ++i) {
    last_->u[static_cast<Eigen::Index>(i)] = solution_[dofs_[i]];
  }
  last_->by_factor = last_->u;
  if (lost_) add_lost();
}

const Eigen::VectorXd& CondensedBase::load(const Forces& forces) {
  last_ = forces.dofs.size() == place_.size() ? &loads_of_all_ : &loads_of_some_;
  if (last_->load.take(forces)) {
    last_->outside = !inside(forces.dofs);
    if (last_->outside) {
      apply_everywhere(forces.dofs, forces.values);
    } else {
      apply_inside(forces.dofs, forces.values);
    }
  }
  return project(last_->u);
}

const Eigen::VectorXd& CondensedBase::project(const Eigen::VectorXd& v) {
  const auto count = static_cast<Eigen::Index>(vectors_.size());
  if (projected_.size() < count) projected_.resize(2 * count + 256);
  for (std::size_t i = 0; i < vectors_.size(); ++i) {
    const auto [dof, other] = vectors_[i];
    const double u = v[place_[dof]];
    projected_[static_cast<Eigen::Index>(i)] = other == kNone ? u : u - v[place_[other]];
  }
  return projected_;
}

void CondensedBase::multiply_by(RegionProduct* product) {
  product_ = product;
  if (product_) product_->begin(*this);
}

/// B c, on the places that B touches.
void CondensedBase::collect_forces(const Eigen::VectorXd& c) {
  forces_.assign(touched_.size(), 0.0);
  for (Index i = 0; i < count(); ++i) {
    const auto [dof, other] = vectors_[static_cast<std::size_t>(i)];
    forces_[is_touched_[place_[dof]]] += c[i];
    if (other != kNone) forces_[is_touched_[place_[other]]] -= c[i];
  }
}

/// u_ += X_SS of the places there_ times their forces, in the rows from one on.
void CondensedBase::add_grown_rows(Index from) {
  for (Eigen::Index i = from; i < u_.size(); ++i) {
    const GrownInverse::Column row = x_.column(i);  // it is symmetric
    double sum = 0;
    for (std::size_t t = 0; t < there_.size(); ++t) sum += forces_there_[t] * row[there_[t]];
    u_[i] += sum;
  }
}

/// u_ += X_SS forces_, by product_ as far as that has the columns.
void CondensedBase::multiply_there() {
  there_.clear();
  forces_there_.clear();
  loaded_.clear();
  loads_.clear();
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    const bool there = there_.size() < product_->most() && product_->has(touched_[i]);
    (there ? there_ : loaded_).push_back(touched_[i]);
    (there ? forces_there_ : loads_).push_back(forces_[i]);
  }
  if (!there_.empty()) {
    product_->add(there_, forces_there_, u_);
    add_grown_rows(product_->rows());
  }
  if (!loaded_.empty()) add(x_, loaded_, loads_, u_.data());
}

void CondensedBase::expand(const Eigen::VectorXd& c, Eigen::VectorXd& u) {
  mended_.setZero(u_.size());
  multiply(c);
  write(u);
}

void CondensedBase::expand_mended(const Eigen::VectorXd& c, Eigen::VectorXd& u) {
  multiply(c);
  u_ += mended_;
  write(u);
}

/// u_ = (X (f + B c))_S.
void CondensedBase::multiply(const Eigen::VectorXd& c) {
  collect_forces(c);
  u_.setZero();
  if (product_ && product_->follow(*this, touched_)) {
    multiply_there();
  } else {
    add(x_, touched_, forces_, u_.data());
  }
  u_ += last_->u;
}

void CondensedBase::write(Eigen::VectorXd& u) const {
  if (u.size() != size()) u.setZero(size());
  for (std::size_t i = 0; i < dofs_.size(); ++i) u[dofs_[i]] = u_[static_cast<Eigen::Index>(i)];
}

bool CondensedBase::inside(std::span<const Index> dofs) const {
  return std::ranges::all_of(dofs, [&](Index d) { return place_[d] != kNone; });
}

/// y += x times a vector by the columns at its entries that are not 0: these are few.
void CondensedBase::add_product(const GrownInverse& x, const Eigen::VectorXd& v,
                                Eigen::VectorXd& y) {
  loaded_.clear();
  loads_.clear();
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    if (v[i] == 0) continue;
    loaded_.push_back(static_cast<Index>(i));
    loads_.push_back(v[i]);
  }
  if (!loaded_.empty()) add(x, loaded_, loads_, y.data());
}

const Eigen::VectorXd& CondensedBase::drift() {
  if (lost_) {
    find_lost_forces(u_);
  } else {
    all_forces_.setZero(u_.size());
  }
  lacks_ = -u_;
  const LastLoad& load = last_->load;
  if (last_->outside) {
    lacks_ += last_->by_factor;
  } else {
    for (std::size_t i = 0; i < load.dofs().size(); ++i) {
      all_forces_[place_[load.dofs()[i]]] += load.values()[i];
    }
  }
  for (std::size_t i = 0; i < touched_.size(); ++i) all_forces_[touched_[i]] += forces_[i];
  add_product(x_of_factor_, all_forces_, lacks_);
  if (lost_) {
    find_lost_forces(lacks_);
    add_product(x_, all_forces_, lacks_);
  }
  return lacks_;
}

const Eigen::VectorXd& CondensedBase::project_mended() {
  mended_ += drift();
  lacks_ += u_;
  return project(lacks_);
}

void CondensedBase::copy_state(CondensedState& to) const {
  to.factor = factor_;
  to.dofs = dofs_;
  to.x = x_;
  to.x_of_factor = x_of_factor_;
  to.lost = lost_;
  to.vectors = vectors_;
}

void CondensedBase::equilibrium(Equilibrium& of) const {
  of.factor = factor_;
  const LastLoad& load = last_->load;
  of.dofs.assign(load.dofs().begin(), load.dofs().end());
  of.forces.assign(load.values().begin(), load.values().end());
  for (std::size_t i = 0; i < touched_.size(); ++i) {
    of.dofs.push_back(dofs_[touched_[i]]);
    of.forces.push_back(forces_[i]);
  }
  of.lost = lost_;
  of.lost_u.clear();
  if (!lost_) return;
  for (Index d : lost_->dofs()) of.lost_u.push_back(u_[place_[d]]);
}

std::vector<BufferPlan> CondensedBase::buffers() const {
  std::vector<BufferPlan> plan{{"condensed inverse (dense, |S| x |S|)", x_.bytes()}};
  if (!x_.same_as(x_of_factor_)) {
    plan.push_back({"condensed inverse of the factor", x_of_factor_.bytes()});
  }
  if (lost_) plan.push_back({"stiffness lost between factor and inverse", lost_->bytes()});
  plan.push_back({"loads outside the condensed region",
                  static_cast<std::size_t>(size()) * (5 * sizeof(double) + sizeof(Index))});
  return plan;
}

}  // namespace sunder::solver
